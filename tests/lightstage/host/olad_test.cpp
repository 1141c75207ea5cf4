// SPDX-License-Identifier: LGPL-2.1-or-later
// The sent data, as received by the Open Lighting Architecture's daemon.
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <random>
#include <sstream>
#include <system_error>
#include <thread>

#include "common/error.hpp"
#include "kernels/lightstage/controllers/descriptor.hpp"
#include "kernels/lightstage/controllers/dmx_levels.hpp"
#include "kernels/lightstage/controllers/light_driver.hpp"
#include "kernels/lightstage/controllers/sacn_receiver.hpp"
#include "kernels/lightstage/controllers/udp.hpp"
#include "tests/expect_error.hpp"
#include "tests/temporary_folder.hpp"

namespace inverse::testing {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

/// The reply of a web server on loopback; empty if there is none.
std::string http(uint16_t port, const std::string& request) {
  Descriptor socket(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  const auto address = udp::ipv4(INADDR_LOOPBACK, port);
  if (connect(socket.get(), reinterpret_cast<const sockaddr*>(&address.storage), address.size) != 0)
    return "";
  if (write(socket.get(), request.data(), request.size()) < 0) return "";
  std::string answer;
  std::array<char, 4096> bytes;
  pollfd wanted{socket.get(), POLLIN, 0};
  while (poll(&wanted, 1, 3000) > 0) {
    const ssize_t size = read(socket.get(), bytes.data(), bytes.size());
    if (size <= 0) break;
    answer.append(bytes.data(), static_cast<size_t>(size));
  }
  return answer;
}

std::string get(uint16_t port, const std::string& path) {
  return http(port, "GET " + path + " HTTP/1.0\r\n\r\n");
}

std::string post(uint16_t port, const std::string& path, const std::string& form) {
  return http(port, "POST " + path +
                        " HTTP/1.0\r\nContent-Type: application/x-www-form-urlencoded\r\n"
                        "Content-Length: " +
                        std::to_string(form.size()) + "\r\n\r\n" + form);
}

/// olad on loopback with two E1.31 inputs only; ended by the destructor.
class Olad {
 public:
  Olad() {
    // Otherwise it would use any connected hardware.
    for (const char* plugin :
         {"artnet", "dmx4linux",  "dummy",   "espnet",   "ftdidmx",  "gpio",
          "karate", "kinet",      "milinst", "nanoleaf", "opendmx",  "openpixelcontrol",
          "osc",    "pathport",   "renard",  "sandnet",  "shownet",  "spi",
          "spidmx", "stageprofi", "uartdmx", "usbdmx",   "usbserial"})
      std::ofstream(folder_ / ("ola-" + std::string(plugin) + ".conf")) << "enabled = false\n";
    std::ofstream(folder_ / "ola-e131.conf")
        << "enabled = true\nip = 127.0.0.1\ninput_ports = 2\noutput_ports = 0\n";
    fs::permissions(folder_.path(), fs::perms::all);
    for (const auto& file : fs::directory_iterator(folder_.path()))
      fs::permissions(file, fs::perms::all & ~fs::perms::owner_exec);
    const auto seed = static_cast<uint16_t>(getpid() % 10000);
    http_ = static_cast<uint16_t>(21000 + seed);
    rpc_ = static_cast<uint16_t>(32000 + seed);
    const std::string web = std::to_string(http_), rpc = std::to_string(rpc_);
    const std::string log = folder_ / "log";
    pid_ = fork();
    if (pid_ < 0) throw std::system_error(errno, std::generic_category(), "fork");
    if (pid_ == 0) {
      if (!freopen(log.c_str(), "w", stderr) || !freopen("/dev/null", "r", stdin)) _exit(126);
      const std::string config = folder_.path();
      // It refuses to run as root.
      if (geteuid() == 0)
        execlp("setpriv", "setpriv", "--reuid=65534", "--regid=65534", "--clear-groups", "olad",
               "--config-dir", config.c_str(), "--http-port", web.c_str(), "--rpc-port",
               rpc.c_str(), "--no-register-with-dns-sd", nullptr);
      else
        execlp("olad", "olad", "--config-dir", config.c_str(), "--http-port", web.c_str(),
               "--rpc-port", rpc.c_str(), "--no-register-with-dns-sd", nullptr);
      _exit(127);
    }
  }
  Olad(const Olad&) = delete;
  Olad& operator=(const Olad&) = delete;
  ~Olad() {
    kill(pid_, SIGTERM);
    for (int i = 0; i < 50 && waitpid(pid_, nullptr, WNOHANG) == 0; ++i)
      std::this_thread::sleep_for(milliseconds(100));
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }

  /// Gives the next free input of E1.31 to a universe.
  bool listen(uint32_t universe) {
    for (int i = 0; i < 100; ++i) {
      const std::string ports = get(http_, "/json/get_ports");
      const size_t id = ports.find("\"id\": \"");
      if (id != std::string::npos) {
        const std::string port = ports.substr(id + 7, ports.find('"', id + 7) - id - 7);
        const std::string number = std::to_string(universe);
        const std::string made = post(http_, "/new_universe",
                                      "id=" + number + "&name=u" + number + "&add_ports=" + port);
        if (made.find("\"ok\": true") != std::string::npos) return true;
      }
      std::this_thread::sleep_for(milliseconds(100));
    }
    return false;
  }
  std::vector<int> levels(uint32_t universe) {
    const std::string answer = get(http_, "/get_dmx?u=" + std::to_string(universe));
    const size_t start = answer.find('['), end = answer.find(']');
    std::vector<int> result;
    if (start == std::string::npos || end == std::string::npos) return result;
    std::istringstream list(answer.substr(start + 1, end - start - 1));
    std::string number;
    while (std::getline(list, number, ',')) result.push_back(std::stoi(number));
    return result;
  }
  uint16_t rpc_port() const { return rpc_; }
  std::string log() const {
    std::ifstream file(folder_ / "log");
    return {std::istreambuf_iterator<char>(file), {}};
  }

 private:
  testing::TemporaryFolder folder_;
  uint16_t http_ = 0, rpc_ = 0;
  pid_t pid_ = -1;
};

/// A stage that fills one universe and most of a second one.
LightProgram large_stage() {
  LightProgram program = static_capture(stage_lights(geodesic_directions(331)), 60);
  std::mt19937 random(3);
  std::uniform_real_distribution<float> level(0, 1);
  LightStep custom{StepKind::custom};
  for (size_t i = 0; i < program.lights.size(); ++i)
    custom.colors.push_back({level(random), level(random), level(random)});
  program.steps = {{StepKind::gradient_a},
                   {StepKind::gradient_b},
                   {StepKind::olat, 200},
                   custom,
                   {StepKind::tracking}};
  program.marker = LightProgram::Marker::none;
  program.check();
  return program;
}

class OladTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (system("command -v olad >/dev/null") != 0) GTEST_SKIP() << "olad is missing: install ola";
    try {
      sacn::Receiver(":5568", std::vector<uint32_t>{});
    } catch (const Error& error) {
      GTEST_SKIP() << "olad needs this port: " << error.what();
    }
    olad_.emplace();
    ASSERT_TRUE(olad_->listen(1)) << olad_->log();
    ASSERT_TRUE(olad_->listen(2)) << olad_->log();
  }

  void expect_levels(const std::map<uint32_t, DmxUniverse>& wanted, const std::string& when) {
    for (const auto& [universe, levels] : wanted) {
      const std::vector<int> expected(levels.begin(), levels.end());
      std::vector<int> heard;
      for (int i = 0; i < 50 && heard != expected; ++i) {
        std::this_thread::sleep_for(milliseconds(20));
        heard = olad_->levels(universe);
      }
      EXPECT_EQ(heard, expected) << when << " universe " << universe << "\n" << olad_->log();
    }
  }

  void expect_all_steps(const LightDriverSettings& settings) {
    const auto driver = make_light_driver(settings);
    driver->upload(program_);
    for (uint64_t t = 0; t <= program_.steps.size(); ++t) {
      driver->show(t);
      expect_levels(DmxPatch(program_, 1).levels(program_.colors(program_.at(t))),
                    "trigger " + std::to_string(t));
    }
  }

  const LightProgram program_ = large_stage();
  std::optional<Olad> olad_;
};

TEST_F(OladTest, ReadsOurPackets) {
  LightDriverSettings settings;
  settings.backend = LightDriverSettings::Backend::sacn;
  settings.sacn.destination = "127.0.0.1";
  expect_all_steps(settings);
}

TEST_F(OladTest, IsDrivenByItsClient) {
  LightDriverSettings settings;
  settings.backend = LightDriverSettings::Backend::ola;
  settings.ola.port = olad_->rpc_port();
  if (!INVERSE_HAVE_OLA) GTEST_SKIP() << "built without libola-dev";
  expect_all_steps(settings);
  // Another sender of its own, for its end.
  const auto driver = make_light_driver(settings);
  driver->upload(program_);
  driver->show(4);
  std::this_thread::sleep_for(milliseconds(3000));  // longer than olad's timeout of a source
  expect_levels(DmxPatch(program_, 1).levels(program_.colors(program_.at(4))), "after 3 s");
  olad_.reset();
  std::string error;
  for (int i = 0; i < 100 && error.empty(); ++i) try {
      driver->show(static_cast<uint64_t>(i));
      std::this_thread::sleep_for(milliseconds(20));
    } catch (const Error& thrown) {
      error = thrown.what();
    }
  expect_contains(error, "closed the connection");
}

TEST(Ola, AMissingDaemonIsAnError) {
  LightDriverSettings settings;
  settings.backend = LightDriverSettings::Backend::ola;
  settings.ola.port = 1;  // nothing answers there
  expect_contains(error_of([&] { make_light_driver(settings)->upload(large_stage()); }),
                  INVERSE_HAVE_OLA ? "olad on port 1" : "libola-dev");
}

}  // namespace
}  // namespace inverse::testing
