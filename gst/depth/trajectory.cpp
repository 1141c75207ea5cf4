// SPDX-License-Identifier: LGPL-2.1-or-later
#include "trajectory.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "common/error.hpp"
#include "text_lines.hpp"

namespace inverse {
namespace {

using Rows = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;

constexpr double kFarthest = 1e6;  // meters; what is beyond is no place of a camera

}  // namespace

bool is_pose(std::span<const double, 12> rows) {
  constexpr double kTolerance = 1e-2;
  const Eigen::Map<const Rows> matrix(rows.data());
  const Eigen::Matrix3d left = matrix.leftCols<3>();
  return matrix.allFinite() && left.isUnitary(kTolerance) && left.determinant() > 0 &&
         matrix.col(3).cwiseAbs().maxCoeff() < kFarthest;
}

Trajectory::Trajectory(const std::string& path, std::vector<std::string>& warnings) {
  constexpr const char* kLine = "time tx ty tz qx qy qz qw";
  constexpr double kTolerance = 0.1;  // of the quaternion's norm
  read_lines(path, kLine, warnings, [this](const Words& words) {
    std::array<double, 8> numbers{};
    if (words.size() != numbers.size()) return false;
    for (size_t i = 0; i < numbers.size(); ++i) {
      const auto number = i == 0 ? time_number(words[i]) : finite_number(words[i]);
      if (!number) return false;
      numbers[i] = *number;
    }
    Entry entry{numbers[0], {}, {}};
    std::copy_n(&numbers[1], 3, entry.place.begin());
    std::copy_n(&numbers[4], 4, entry.rotation.begin());
    Eigen::Map<Eigen::Vector4d> rotation(entry.rotation.data());
    const Eigen::Map<const Eigen::Vector3d> place(entry.place.data());
    if (!(std::abs(rotation.norm() - 1) < kTolerance) || !(place.norm() < kFarthest)) return false;
    rotation.normalize();
    entries_.push_back(entry);
    return true;
  });
  if (entries_.empty())
    throw Error(ErrorKind::file,
                path + " has no poses; each of its lines is to be \"" + kLine + "\"");
  order_by_time(entries_, path, warnings);
}

PoseRows Trajectory::rows_between(const Entry& a, const Entry& b, double part) {
  using Place = Eigen::Map<const Eigen::Vector3d>;
  using Turn = Eigen::Map<const Eigen::Quaterniond>;
  PoseRows rows;
  Eigen::Map<Rows> matrix(rows.data());
  matrix.leftCols<3>() =
      Turn(a.rotation.data()).slerp(part, Turn(b.rotation.data())).toRotationMatrix();
  matrix.col(3) = (1 - part) * Place(a.place.data()) + part * Place(b.place.data());
  return rows;
}

std::optional<PoseRows> Trajectory::at(double seconds, double tolerance) const {
  const auto after = std::ranges::lower_bound(entries_, seconds, {}, &Entry::seconds);
  const auto near = [&](auto entry) { return std::abs(entry->seconds - seconds) <= tolerance; };
  const bool has_after = after != entries_.end() && near(after),
             has_before = after != entries_.begin() && near(after - 1);
  if (has_after && has_before) {
    const double from = (after - 1)->seconds;
    return rows_between(*(after - 1), *after, (seconds - from) / (after->seconds - from));
  }
  if (has_after) return rows_between(*after, *after, 0);
  if (has_before) return rows_between(*(after - 1), *(after - 1), 0);
  return {};
}

std::string Trajectory::span() const {
  std::array<char, 96> text{};
  std::snprintf(text.data(), text.size(), "from %.3f to %.3f s", entries_.front().seconds,
                entries_.back().seconds);
  return text.data();
}

}  // namespace inverse
