// SPDX-License-Identifier: LGPL-2.1-or-later
#include "own_process.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include "element_test.hpp"
#include "tests/pipeline.hpp"

namespace inverse::testing {
namespace {

constexpr unsigned kTimeout = 120;  // seconds

int launch(const char* line) {
  const auto result = run_line(line, kTimeout);
  for (const auto& error : result.errors) fprintf(stderr, "%s\n", error.c_str());
  return result.eos && result.errors.empty() ? 0 : 1;
}

int restart(const std::string& state, const char* line) {
  Pipeline pipeline(line);
  for (int time = 0; time < 2; ++time) {
    pipeline.set(GST_STATE_PLAYING);
    const auto type = pipeline.waited_for(GST_MESSAGE_EOS | GST_MESSAGE_ERROR);
    printf("%s\n", type == GST_MESSAGE_EOS ? "end" : "error");
    pipeline.set(state == "ready" ? GST_STATE_READY : GST_STATE_NULL);
    gst_bus_set_flushing(pipeline.bus(), TRUE);
    gst_bus_set_flushing(pipeline.bus(), FALSE);
  }
  return 0;
}

/// Marks a pixel before there is any frame.
int mark(const char* line) {
  Pipeline pipeline(line);
  g_signal_emit_by_name(pipeline.find("marked"), "mark", 3, 3);
  pipeline.set(GST_STATE_PLAYING);
  for (bool ended = false; !ended;) {
    GstMessage* message = gst_bus_timed_pop_filtered(
        pipeline.bus(), GST_CLOCK_TIME_NONE,
        static_cast<GstMessageType>(GST_MESSAGE_EOS | GST_MESSAGE_ERROR | GST_MESSAGE_ELEMENT));
    ended = GST_MESSAGE_TYPE(message) != GST_MESSAGE_ELEMENT;
    printf("%s\n", ended ? GST_MESSAGE_TYPE_NAME(message)
                         : gst_structure_get_name(gst_message_get_structure(message)));
    gst_message_unref(message);
  }
  return 0;
}

}  // namespace

Ended run_self(const std::map<std::string, std::string>& environment,
               const std::vector<std::string>& arguments) {
  gchar** variables = g_get_environ();
  for (const auto& [name, value] : environment)
    variables = g_environ_setenv(variables, name.c_str(), value.c_str(), TRUE);
  gchar* self = g_file_read_link("/proc/self/exe", nullptr);
  std::vector<gchar*> words{self};
  for (const auto& argument : arguments) words.push_back(const_cast<gchar*>(argument.c_str()));
  words.push_back(nullptr);
  gchar *out = nullptr, *err = nullptr;
  gint status = -1;
  g_spawn_sync(nullptr, words.data(), variables, G_SPAWN_DEFAULT, nullptr, nullptr, &out, &err,
               &status, nullptr);
  const Ended ended{WIFEXITED(status) ? WEXITSTATUS(status) : -1,
                    std::string(out ? out : "") + (err ? err : "")};
  g_free(out);
  g_free(err);
  g_free(self);
  g_strfreev(variables);
  return ended;
}

int serve(int count, char** arguments) {
  const std::string option = count > 1 ? arguments[1] : "";
  if (option == kLaunchOption || option == kRestartOption || option == kMarkOption) alarm(kTimeout);
  if (option == kLaunchOption && count == 3) return launch(arguments[2]);
  if (option == kMarkOption && count == 3) return mark(arguments[2]);
  if (option == kRestartOption && count == 4) return restart(arguments[2], arguments[3]);
  return -1;
}

}  // namespace inverse::testing
