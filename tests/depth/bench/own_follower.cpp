// SPDX-License-Identifier: LGPL-2.1-or-later
#include <cstring>

#include "follower.hpp"
#include "kernels/depth/tracking/tracker.hpp"

namespace inverse::bench {
namespace {

class Own final : public Follower {
 public:
  Own(const Lab& lab, const Setting& setting, float photometric)
      : setting_(setting),
        before_(lab.device()->memory_bytes()),
        volume_(lab.device(), {.voxel = float(setting.voxel)}),
        tracker_(lab.device(), setting.extent),
        view_(lab.device(), setting.extent),
        commands_(lab.device()) {
    params_.photometric = {photometric, photometric, 0};
    bytes = lab.device()->memory_bytes() - before_;
  }

  bool follow(const Lab& lab, const Seen& seen) override {
    const RgbdFrame& frame = seen.frame;
    const bool given = first_ || !setting_.tracked;
    const auto place = pose_on(lab, frame.pose), picture = lab.upload(seen.picture);
    commands_.begin();
    tracker_.record_frame(commands_, setting_.lens, frame.depth, picture);
    if (given)
      tracker_.record_pose(commands_, place);
    else
      tracker_.record_align(commands_, params_);
    commands_.stage("following");
    volume_.record_integrate(
        commands_,
        {setting_.lens, setting_.extent, tracker_.pose(), frame.depth, tracker_.surface()}, picture,
        {});
    commands_.stage("fusion");
    volume_.record_march(commands_, setting_.lens, tracker_.pose(), view_);
    tracker_.record_target(commands_, view_, picture);
    commands_.stage("rendering");
    commands_.submit();
    commands_.wait();
    for (size_t i = 0; i < parts.size(); ++i)
      parts[i] = commands_.stages().empty() ? 0 : commands_.stages()[i].milliseconds;
    first_ = false;
    return given || lab.download(tracker_.found())[0] == 1;
  }

  Pose pose(const Lab& lab) const override {
    const Pixels values = lab.download(tracker_.pose());
    Pose pose;
    std::copy_n(values.begin(), 4, pose.rotation.begin());
    std::copy_n(values.begin() + 4, 4, pose.place.begin());
    return pose;
  }

  std::vector<float> depth_from(const Lab& lab, const Pose& pose) override {
    const auto place = pose_on(lab, pose);
    lab.run([&](gpu::Commands& commands) {
      volume_.record_march(commands, setting_.lens, place, view_);
    });
    return lab.download(view_.depth);
  }

 private:
  Setting setting_;
  uint64_t before_;
  Volume volume_;
  Tracker tracker_;
  Volume::View view_;
  gpu::Commands commands_;
  Tracker::Params params_;
  bool first_ = true;
};

NamedFollower own(const char* name, float photometric) {
  return {name, [photometric](const Lab& lab, const Setting& setting) {
            return std::make_unique<Own>(lab, setting, photometric);
          }};
}

}  // namespace

std::vector<NamedFollower> own_followers() {
  return {own("ours", Tracker::Params{}.photometric[0]), own("ours, geometry alone", 0)};
}

}  // namespace inverse::bench
