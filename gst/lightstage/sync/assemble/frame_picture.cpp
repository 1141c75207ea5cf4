// SPDX-License-Identifier: LGPL-2.1-or-later
#include "frame_picture.hpp"

namespace inverse {

cv::Mat read_codes(const GstVideoInfo& info, GstBuffer* buffer) {
  const RawFrame frame(info, buffer, GST_MAP_READ);
  cv::Mat codes(static_cast<int>(frame.height()), static_cast<int>(frame.width()),
                frame.wide() ? CV_16UC4 : CV_8UC4);
  for (uint32_t row = 0; row < frame.height(); ++row)
    frame.unpack(row, codes.ptr(static_cast<int>(row)));
  return codes;
}

void write_codes(const GstVideoInfo& info, GstBuffer* buffer, const cv::Mat& codes) {
  RawFrame frame(info, buffer, GST_MAP_WRITE);
  cv::Mat row;
  for (uint32_t y = 0; y < frame.height(); ++y) {
    codes.row(static_cast<int>(y)).copyTo(row);  // packing may write to its source
    frame.pack(y, row.data);
  }
}

cv::Mat linear_light(const Linearizer& linear, const cv::Mat& codes) {
  cv::Mat light(codes.size(), CV_32FC3);
  for (int y = 0; y < codes.rows; ++y) {
    auto* to = light.ptr<float>(y);
    for (int x = 0; x < codes.cols; ++x)
      if (codes.depth() == CV_16U)
        linear(codes.ptr<uint16_t>(y) + size_t{4} * static_cast<size_t>(x), to + ptrdiff_t{3} * x);
      else
        linear(codes.ptr<uint8_t>(y) + size_t{4} * static_cast<size_t>(x), to + ptrdiff_t{3} * x);
  }
  return light;
}

}  // namespace inverse
