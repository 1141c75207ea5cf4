// SPDX-License-Identifier: LGPL-2.1-or-later
#include "frame_sets.hpp"

namespace inverse {

void FrameSets::forget_frames(uint32_t camera) {
  for (auto set = sets_.begin(); set != sets_.end();) {
    set->second.erase(camera);
    set = set->second.empty() ? sets_.erase(set) : std::next(set);
  }
  if (const auto found = cameras_.find(camera); found != cameras_.end())
    found->second.latest.reset();
}

void FrameSets::wait_for(uint32_t camera, bool wait) {
  if (const auto found = cameras_.find(camera); found != cameras_.end())
    found->second.waited_for = wait;
}

void FrameSets::remove_camera(uint32_t camera) {
  forget_frames(camera);
  cameras_.erase(camera);
}

void FrameSets::add(uint32_t camera, uint64_t key, uint64_t token) {
  const auto found = cameras_.find(camera);
  if (found == cameras_.end()) return;
  sets_[key][camera] = token;
  found->second.latest = key;
}

std::vector<uint32_t> FrameSets::lacking() const {
  std::vector<uint32_t> found;
  if (sets_.empty()) return found;
  const auto& [key, frames] = *sets_.begin();
  for (const auto& [number, camera] : cameras_)
    if (camera.waited_for && !frames.contains(number) && (!camera.latest || *camera.latest < key))
      found.push_back(number);
  return found;
}

std::vector<FrameSets::Decided> FrameSets::decide() {
  std::vector<Decided> out;
  while (!sets_.empty() && lacking().empty()) {
    const auto& frames = sets_.begin()->second;
    const bool whole = frames.size() == cameras_.size();
    ++(whole ? complete_sets_ : incomplete_sets_);
    for (const auto& [camera, token] : frames) out.push_back({camera, token, whole || !complete_});
    sets_.erase(sets_.begin());
  }
  return out;
}

}  // namespace inverse
