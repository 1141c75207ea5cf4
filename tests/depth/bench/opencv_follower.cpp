// SPDX-License-Identifier: LGPL-2.1-or-later
// OpenCV's packages lack KinFu and ColoredKinFu (OPENCV_ENABLE_NONFREE), but have the parts: they
// are put together here as KinFu::update of OpenCV 4.6 does it, with its default settings.
#include <malloc.h>

#include <iostream>
#include <limits>
#include <opencv2/core/ocl.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/rgbd.hpp>
#include <opencv2/rgbd/large_kinfu.hpp>
#include <utility>

#include "follower.hpp"
#include "tests/bench/support/timing.hpp"

namespace inverse::bench {
namespace {

using cv::kinfu::VolumeType;
using Matrix = cv::Matx44f;

constexpr int kLevels = 3;
constexpr float kTruncation = 0.04F;  // meters; KinFu's default is .041
constexpr float kMaxDepth = 5;        // as Volume::Params

Matrix matrix_of(const Pose& pose) {
  Matrix matrix = Matrix::eye();
  const auto rows = rows_of(pose);
  for (int i = 0; i < 12; ++i) matrix(i / 4, i % 4) = float(rows[size_t(i)]);
  return matrix;
}
Pose pose_of(const Matrix& matrix) {
  std::array<double, 12> rows;
  for (int i = 0; i < 12; ++i) rows[size_t(i)] = double{matrix(i / 4, i % 4)};
  return pose_of_rows(rows);
}
cv::Matx33f camera_of(const Lens& lens) {
  return {lens.fx, 0, lens.cx, 0, lens.fy, lens.cy, 0, 0, 1};
}
cv::Size size_of(Extent extent) { return {int(extent.width), int(extent.height)}; }
/// The host's pixels, without a copy; OpenCV does not write them.
cv::Mat mat_of(const std::vector<float>& values, Extent extent) {
  const int channels = int(values.size() / extent.pixels());
  return {size_of(extent), CV_32FC(channels), const_cast<float*>(values.data())};
}

/// Adds what is allocated while it exists, and not freed.
class Counted {
 public:
  explicit Counted(uint64_t& bytes) : bytes_(bytes), before_(now()) {}
  Counted(const Counted&) = delete;
  Counted& operator=(const Counted&) = delete;
  ~Counted() { bytes_ += now() - before_; }

 private:
  static uint64_t now() {
    const auto info = mallinfo2();
    return info.uordblks + info.hblkhd;
  }
  uint64_t& bytes_;
  uint64_t before_;
};

/// Ms since the last call, or since it was made.
class Lap {
 public:
  double operator()() {
    const auto before = std::exchange(last_, Clock::now());
    return milliseconds(last_ - before);
  }

 private:
  Clock::time_point last_ = Clock::now();
};

/// Without the preparation of the model's frame, which is rendered.
struct Icp : cv::rgbd::FastICPOdometry {
  using FastICPOdometry::computeImpl;
  using FastICPOdometry::FastICPOdometry;
};

struct Grid {
  VolumeType type = VolumeType::TSDF;
  bool own_size = false;  // voxels and volume of KinFu's defaults
  bool centered = false;  // see KinFu::shift_
};

/// An upright box around the scene, seen from the first camera: its z axis is the world's axis that
/// is nearest to that camera's upward one. OpenCV 4.6 misplaces columns of voxels that begin behind
/// the camera, so that cameras in the volume must look down them.
struct Box {
  cv::Affine3f place;
  cv::Vec3f sides;
};
Box upright_box(const Setting& setting) {
  const Matrix first = matrix_of(setting.first);
  int up = 0;
  for (int c = 1; c < 3; ++c)
    if (std::abs(first(c, 1)) > std::abs(first(up, 1))) up = c;
  const float sign = first(up, 1) > 0 ? -1.0F : 1.0F;
  const int axes[] = {(up + 1) % 3, (up + 2) % 3, up};
  Box box;
  Matrix place = Matrix::eye();
  for (int v = 0; v < 3; ++v) {
    const auto w = size_t(axes[v]);
    const float s = v == 0 ? 1.0F : sign;
    for (int c = 0; c < 3; ++c) place(c, v) = c == axes[v] ? s : 0.0F;
    place(axes[v], 3) = float(s > 0 ? setting.low[w] : setting.high[w]);
    box.sides[v] = float(setting.high[w] - setting.low[w]);
  }
  box.place = first.inv() * place;
  return box;
}

/// Poses are relative to the first camera, as OpenCV has them.
class KinFu final : public Follower {
 public:
  KinFu(const Setting& setting, const Grid& grid)
      : setting_(setting),
        colored_(grid.type == VolumeType::COLOREDTSDF),
        intrinsics_(camera_of(setting.lens)),
        icp_(cv::Mat(camera_of(setting.lens)), 0.1F) {
    const Counted counted(bytes);
    const auto defaults = cv::kinfu::VolumeParams::defaultParams(grid.type);
    const bool hashed = grid.type == VolumeType::HASHTSDF;
    float voxel = float(setting.voxel), truncation = kTruncation;
    cv::Affine3f place = defaults->pose;  // units of a hashed volume are misplaced if it is turned
    cv::Vec3i dims = defaults->resolution;
    if (grid.own_size) {
      voxel = defaults->voxelSize;
      truncation = defaults->tsdfTruncDist;
      const bool limited = defaults->depthTruncThreshold > 0;
      max_depth_ = limited ? defaults->depthTruncThreshold : std::numeric_limits<float>::max();
    } else if (!hashed) {
      const Box box = upright_box(setting);
      place = box.place;
      for (int c = 0; c < 3; ++c) dims[c] = int(box.sides[c] / voxel) + 1;
    }
    if (grid.centered) {
      const cv::Vec3f shift = hashed ? cv::Vec3f(-0.5F, -0.5F, 0.5F) : cv::Vec3f(0, 0, 1);
      shift_ = (place * cv::Affine3f().translate(voxel * shift) * place.inv()).matrix;
    }
    volume_ = cv::kinfu::makeVolume(grid.type, voxel, place.matrix, defaults->raycastStepFactor,
                                    truncation, defaults->maxWeight, max_depth_, dims);
  }

  bool follow(const Lab&, const Seen& seen) override {
    const Counted counted(bytes);
    Lap lap;
    cv::Mat depth;
    cv::threshold(mat_of(seen.depth, setting_.extent), depth, double{max_depth_}, 0,
                  cv::THRESH_TOZERO_INV);
    auto now = cv::rgbd::OdometryFrame::create({}, depth);
    icp_.prepareFrameCache(now, cv::rgbd::OdometryFrame::CACHE_ALL);
    if (!setting_.tracked) {
      pose_ = first_.inv() * matrix_of(seen.frame.pose);
    } else if (model_) {
      cv::Mat motion;
      if (!icp_.computeImpl(now, model_, motion, {})) return false;
      pose_ = pose_ * Matrix(cv::Matx44d(motion));
    }
    parts[0] = lap();
    if (colored_)
      volume_->integrate(depth, 255 * mat_of(seen.picture, setting_.extent), 1, shift_ * pose_,
                         intrinsics_, intrinsics_);
    else
      volume_->integrate(depth, 1, shift_ * pose_, intrinsics_);
    parts[1] = lap();
    if (model_) {
      render(pose_, now->pyramidCloud[0], now->pyramidNormals[0]);
      for (auto* pyramid : {&now->pyramidCloud, &now->pyramidNormals})
        for (size_t l = 1; l < kLevels; ++l)
          cv::resize((*pyramid)[l - 1], (*pyramid)[l], (*pyramid)[l].size(), 0, 0, cv::INTER_AREA);
    }
    parts[2] = lap();
    model_ = now;
    return true;
  }

  Pose pose(const Lab&) const override { return pose_of(first_ * pose_); }

  std::vector<float> depth_from(const Lab&, const Pose& pose) override {
    cv::Mat points, normals, z;
    render(first_.inv() * matrix_of(pose), points, normals);
    cv::extractChannel(points, z, 2);
    cv::patchNaNs(z);
    return {z.begin<float>(), z.end<float>()};
  }

 private:
  void render(const Matrix& pose, cv::Mat& points, cv::Mat& normals) const {
    cv::Mat colors;
    if (colored_)
      volume_->raycast(pose, intrinsics_, size_of(setting_.extent), points, normals, colors);
    else
      volume_->raycast(pose, intrinsics_, size_of(setting_.extent), points, normals);
  }

  Setting setting_;
  bool colored_;
  float max_depth_ = kMaxDepth;
  cv::kinfu::Intr intrinsics_;
  Icp icp_;
  Matrix first_ = matrix_of(setting_.first), pose_ = Matrix::eye();
  /// Of the camera when a frame is added. OpenCV 4.6 shows surfaces of dense volumes one voxel too
  /// low along z, those of hashed ones half a voxel too high along x and y and too low along z;
  /// this takes it out.
  Matrix shift_ = Matrix::eye();
  cv::Ptr<cv::kinfu::Volume> volume_;
  cv::Ptr<cv::rgbd::OdometryFrame> model_;
};

/// From frame to frame; a frame that is not found is taken for one without motion, as in OpenCV's
/// sample odometry_evaluation.
class Odometry final : public Follower {
 public:
  Odometry(const Setting& setting, cv::Ptr<cv::rgbd::Odometry> method)
      : setting_(setting), method_(std::move(method)), pose_(matrix_of(setting.first)) {}

  bool follow(const Lab&, const Seen& seen) override {
    const Counted counted(bytes);
    Lap lap;
    cv::Mat bright, gray, depth = mat_of(seen.depth, setting_.extent).clone();
    cv::pow(mat_of(seen.picture, setting_.extent), 1 / 2.2, bright);
    bright.convertTo(bright, CV_8U, 255);
    cv::cvtColor(bright, gray, cv::COLOR_RGBA2GRAY);
    depth.setTo(std::numeric_limits<float>::quiet_NaN(), depth == 0);
    auto now = cv::rgbd::OdometryFrame::create(gray, depth);
    cv::Mat motion;
    const bool found = !last_ || method_->compute(now, last_, motion);
    if (found && last_) pose_ = pose_ * Matrix(cv::Matx44d(motion));
    last_ = now;
    parts = {lap(), 0, 0};
    return found;
  }
  Pose pose(const Lab&) const override { return pose_of(pose_); }

 private:
  Setting setting_;
  cv::Ptr<cv::rgbd::Odometry> method_;
  Matrix pose_;
  cv::Ptr<cv::rgbd::OdometryFrame> last_;
};

class LargeKinFu final : public Follower {
 public:
  explicit LargeKinFu(const Setting& setting) : setting_(setting) {
    const Counted counted(bytes);
    const auto params = cv::large_kinfu::Params::hashTSDFParams(false);
    params->frameSize = size_of(setting.extent);
    params->intr = camera_of(setting.lens);
    params->depthFactor = 1;
    params->volumeParams.voxelSize = float(setting.voxel);
    params->volumeParams.tsdfTruncDist = kTruncation;
    params->volumeParams.depthTruncThreshold = kMaxDepth;
    const Silent silent;
    method_ = cv::large_kinfu::LargeKinfu::create(params);
  }
  bool follow(const Lab&, const Seen& seen) override {
    const Counted counted(bytes);
    const Silent silent;
    Lap lap;
    const bool found = method_->update(mat_of(seen.depth, setting_.extent));
    parts = {lap(), 0, 0};
    return found;
  }
  Pose pose(const Lab&) const override {
    return pose_of(matrix_of(setting_.first) * method_->getPose().matrix);
  }

 private:
  /// It prints what it does.
  struct Silent {
    Silent() { std::cout.setstate(std::ios::failbit); }
    ~Silent() { std::cout.clear(); }
  };
  Setting setting_;
  cv::Ptr<cv::large_kinfu::LargeKinfu> method_;
};

NamedFollower kinfu(const char* name, const Grid& grid) {
  return {name, [grid](const Lab&, const Setting& setting) {
            return std::make_unique<KinFu>(setting, grid);
          }};
}

}  // namespace

std::vector<NamedFollower> opencv_followers() {
  cv::ocl::setUseOpenCL(false);
  return {
      kinfu("KinFu, TSDF", {}),
      kinfu("KinFu, TSDF, voxels centered", {.centered = true}),
      kinfu("KinFu, ColoredTSDF", {VolumeType::COLOREDTSDF}),
      kinfu("KinFu, HashTSDF", {VolumeType::HASHTSDF}),
      kinfu("KinFu, HashTSDF, voxels centered", {VolumeType::HASHTSDF, false, true}),
      kinfu("KinFu, TSDF of its default size", {VolumeType::TSDF, true}),
      kinfu("KinFu, HashTSDF of its default size", {VolumeType::HASHTSDF, true}),
      {"LargeKinFu",
       [](const Lab&, const Setting& setting) -> std::unique_ptr<Follower> {
         try {
           return std::make_unique<LargeKinFu>(setting);
         } catch (const cv::Exception& error) {
           if (error.code != cv::Error::StsNotImplemented) throw;
           fprintf(stderr, "this OpenCV was built without LargeKinfu\n");
           return nullptr;
         }
       }},
      {"FastICPOdometry, frame to frame",
       [](const Lab&, const Setting& setting) {
         return std::make_unique<Odometry>(
             setting, cv::rgbd::FastICPOdometry::create(cv::Mat(camera_of(setting.lens))));
       }},
      {"RgbdICPOdometry, frame to frame",
       [](const Lab&, const Setting& setting) {
         return std::make_unique<Odometry>(
             setting,
             cv::rgbd::RgbdICPOdometry::create(cv::Mat(camera_of(setting.lens)), 0.1F, kMaxDepth));
       }},
  };
}

}  // namespace inverse::bench
