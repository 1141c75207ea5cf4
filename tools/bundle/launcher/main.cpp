// SPDX-License-Identifier: LGPL-2.1-or-later
// gst-inverse: runs the programs of the bundle around it, with its libraries or the host's. Linked
// statically, as there may be no library that it could use. bin/ has links to it, which run the
// program of that name.
#include <sys/auxv.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <string>
#include <vector>

#include "libraries.hpp"
#include "self_test.hpp"

namespace {

namespace fs = std::filesystem;
using inverse::bundle::Libraries;
using Words = std::vector<std::string>;

constexpr const char* kUsage =
    "gst-inverse run [--window|--file] [--seconds S] [--out FOLDER] [FILE|URI|/dev/videoN]\n"
    "               [-- ELEMENTS]\n"
    "               decomposes the bundled clip, a file or a camera: in a window, or without a\n"
    "               display or with --file to FOLDER (out)\n"
    "gst-inverse launch ELEMENTS\n"
    "               gst-launch-1.0 with the bundle's plugins\n"
    "gst-inverse inspect [ELEMENT]\n"
    "               gst-inspect-1.0: elements, their properties\n"
    "gst-inverse bench [--sizes 640x480,...] [--frames N] [--rounds N] [--json FILE] [ELEMENT "
    "...]\n"
    "               times, commands, barriers and bytes of every element, or of those named;\n"
    "               also written to gst-inverse-bench.json\n"
    "gst-inverse selftest [FILTER]\n"
    "               every kernel against its reference under the Vulkan validation layer, or the\n"
    "               tests that a filter names (SUITE.TEST, * and ?)\n"
    "gst-inverse libraries\n"
    "               which libraries are the host's, which the bundle's\n"
    "INVERSE_DEVICE selects a Vulkan device by index or a part of its name.\n";

/// A folder of this user for the list of plugins, made if missing; empty if none can be.
fs::path cache_folder() {
  const auto value = [](const char* name) {
    const char* text = std::getenv(name);
    return fs::path(text ? text : "");
  };
  std::vector<fs::path> places;
  if (const fs::path cache = value("XDG_CACHE_HOME"); cache.is_absolute())
    places.push_back(cache / "gst-inverse");
  if (const fs::path home = value("HOME"); home.is_absolute())
    places.push_back(home / ".cache/gst-inverse");
  places.push_back("/tmp/gst-inverse-" + std::to_string(geteuid()));
  for (const fs::path& place : places) {
    std::error_code error;
    fs::create_directories(place.parent_path(), error);
    mkdir(place.c_str(), 0700);
    struct stat found {};
    if (lstat(place.c_str(), &found) == 0 && S_ISDIR(found.st_mode) && found.st_uid == geteuid() &&
        access(place.c_str(), W_OK) == 0)
      return place;
  }
  return {};
}

/// GStreamer with the bundle's plugins alone: others may need other libraries.
void set_environment(const fs::path& folder) {
  for (const char* name : {"GST_PLUGIN_PATH", "GST_PLUGIN_PATH_1_0", "GST_PLUGIN_SYSTEM_PATH",
                           "GST_REGISTRY_1_0", "GIO_EXTRA_MODULES"})
    unsetenv(name);
  setenv("GST_PLUGIN_SYSTEM_PATH_1_0", (folder / "plugins").c_str(), 1);
  setenv("GST_REGISTRY_FORK", "no", 1);
  if (const fs::path cache = cache_folder(); !cache.empty())
    setenv("GST_REGISTRY", (cache / "registry.bin").c_str(), 1);
  setenv("GIO_MODULE_DIR", (folder / "lib/none").c_str(), 1);
  setenv("GSETTINGS_BACKEND", "memory", 1);
  setenv("GST_PRESET_PATH", (folder / "presets").c_str(), 0);
  setenv("INVERSE_MODELS", (folder / "models").c_str(), 0);
}

void set_validation(const fs::path& folder) {
  setenv("VK_LAYER_PATH", (folder / "layers").c_str(), 1);
  setenv("INVERSE_VALIDATION", "1", 1);
  setenv("CLIP_TRUTH", (folder / "media/truth/clip.f32").c_str(), 1);
}

/// The words that start a program of the bundle, under a name by which it can start itself again.
Words command(const fs::path& folder, const Libraries& libraries, const std::string& program) {
  const fs::path name = folder / "bin" / program, file = folder / "libexec" / program;
  return {libraries.loader, "--library-path", libraries.path, "--argv0", name, file};
}

int execute(Words words) {
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  execv(pointers[0], pointers.data());
  std::fprintf(stderr, "cannot start %s: %s\n", pointers[0], std::strerror(errno));
  return 127;
}

int print_libraries(const Libraries& libraries) {
  for (const auto& library : libraries.shared) {
    const char* whose = library.from_host() ? "host  " : "bundle";
    const std::string why = library.host.empty() ? "the host has none"
                            : library.lacks.empty()
                                ? library.host.string()
                                : library.host.string() + " lacks " + library.lacks;
    std::printf("%s %s: %s\n", whose, library.name.c_str(), why.c_str());
  }
  return 0;
}

int run(const fs::path& called, const Words& words) {
  // The path that started this program, also where there is no /proc.
  // NOLINTNEXTLINE(performance-no-int-to-ptr): that is how the system hands it over
  const auto* own = reinterpret_cast<const char*>(getauxval(AT_EXECFN));
  const fs::path folder = fs::canonical(own).parent_path(), clip = folder / "media/clip.webm";
  const Libraries libraries = inverse::bundle::choose_libraries(folder);
  set_environment(folder);
  Words line;
  if (called.filename() != "gst-inverse") {
    line = command(folder, libraries, called.filename());
    line.insert(line.end(), words.begin(), words.end());
    return execute(std::move(line));
  }
  const std::string name = words.empty() ? "help" : words[0];
  if (name == "help" || name == "--help" || name == "-h") return std::fputs(kUsage, stdout) < 0;
  if (name == "libraries") return print_libraries(libraries);
  if (name == "run") {
    line = command(folder, libraries, "inverse-run");
    line.insert(line.end(), {"--clip", clip});
  } else if (name == "launch") {
    line = command(folder, libraries, "gst-launch-1.0");
  } else if (name == "inspect") {
    line = command(folder, libraries, "gst-inspect-1.0");
  } else if (name == "bench") {
    line = command(folder, libraries, "element-bench");
    line.insert(line.end(), {"--clip", clip, "--json", "gst-inverse-bench.json"});
  } else if (name == "selftest" && words.size() <= 2) {
    set_validation(folder);
    return inverse::bundle::self_test(command(folder, libraries, "kernel-tests"),
                                      words.size() == 2 ? words[1] : "");
  } else {
    std::fputs(kUsage, stderr);
    return 2;
  }
  line.insert(line.end(), words.begin() + 1, words.end());
  return execute(std::move(line));
}

}  // namespace

int main(int count, char** words) {
  try {
    return run(words[0], {words + 1, words + count});
  } catch (const std::exception& error) {
    std::fprintf(stderr, "gst-inverse: %s\n", error.what());
    return 1;
  }
}
