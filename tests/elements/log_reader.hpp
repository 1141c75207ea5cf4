// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/gst.h>

#include <algorithm>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace inverse::testing {

/// Records the log of one category.
class LogReader {
 public:
  explicit LogReader(const char* category, GstDebugLevel level) : category_(category) {
    gst_debug_set_threshold_for_name(category, level);
    gst_debug_add_log_function(record, this, nullptr);
  }
  LogReader(const LogReader&) = delete;
  LogReader& operator=(const LogReader&) = delete;
  ~LogReader() {
    gst_debug_remove_log_function_by_data(this);
    gst_debug_unset_threshold_for_name(category_.c_str());
  }

  /// Messages of this level with this text.
  size_t count(GstDebugLevel level, const std::string& text) const {
    std::lock_guard lock(mutex_);
    return static_cast<size_t>(std::count_if(lines_.begin(), lines_.end(), [&](const auto& line) {
      return line.first == level && line.second.find(text) != std::string::npos;
    }));
  }
  bool empty() const {
    std::lock_guard lock(mutex_);
    return lines_.empty();
  }

 private:
  static void record(GstDebugCategory* category, GstDebugLevel level, const gchar*, const gchar*,
                     gint, GObject*, GstDebugMessage* message, gpointer self) {
    auto& reader = *static_cast<LogReader*>(self);
    if (reader.category_ != gst_debug_category_get_name(category)) return;
    std::lock_guard lock(reader.mutex_);
    reader.lines_.emplace_back(level, gst_debug_message_get(message));
  }

  std::string category_;
  mutable std::mutex mutex_;
  std::vector<std::pair<GstDebugLevel, std::string>> lines_;
};

}  // namespace inverse::testing
