// What we send, as the Open Lighting Architecture's daemon understands it.
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>
#include <thread>

#include "error.hpp"
#include "light_stage/descriptor.hpp"
#include "light_stage/dmx_levels.hpp"
#include "light_stage/light_driver.hpp"
#include "light_stage/sacn_receiver.hpp"
#include "light_stage/udp.hpp"

namespace inverse::testing {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

/// What a web server on loopback answers; empty where there is none.
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

/// olad on loopback with two inputs of E1.31 and nothing else; ended by the destructor.
class Olad {
 public:
  Olad() {
    std::string name = (fs::temp_directory_path() / "inverse-olad-XXXXXX").string();
    if (!mkdtemp(name.data())) throw std::runtime_error("no folder for olad");
    folder_ = name;
    // It would talk to whatever hardware it finds.
    for (const char* plugin :
         {"artnet", "dmx4linux",  "dummy",   "espnet",   "ftdidmx",  "gpio",
          "karate", "kinet",      "milinst", "nanoleaf", "opendmx",  "openpixelcontrol",
          "osc",    "pathport",   "renard",  "sandnet",  "shownet",  "spi",
          "spidmx", "stageprofi", "uartdmx", "usbdmx",   "usbserial"})
      std::ofstream(folder_ / ("ola-" + std::string(plugin) + ".conf")) << "enabled = false\n";
    std::ofstream(folder_ / "ola-e131.conf")
        << "enabled = true\nip = 127.0.0.1\ninput_ports = 2\noutput_ports = 0\n";
    fs::permissions(folder_, fs::perms::all);
    for (const auto& file : fs::directory_iterator(folder_))
      fs::permissions(file, fs::perms::all & ~fs::perms::owner_exec);
    const auto seed = static_cast<uint16_t>(getpid() % 10000);
    http_ = static_cast<uint16_t>(21000 + seed);
    const std::string web = std::to_string(http_), rpc = std::to_string(32000 + seed);
    const std::string log = (folder_ / "log").string();
    pid_ = fork();
    if (pid_ == 0) {
      if (!freopen(log.c_str(), "w", stderr) || !freopen("/dev/null", "r", stdin)) _exit(126);
      const std::string config = folder_.string();
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
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
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
  std::string log() const {
    std::ifstream file(folder_ / "log");
    return {std::istreambuf_iterator<char>(file), {}};
  }

 private:
  fs::path folder_;
  uint16_t http_ = 0;
  pid_t pid_ = -1;
};

TEST(Olad, ReadsOurLevels) {
  if (system("command -v olad >/dev/null") != 0) GTEST_SKIP() << "olad is missing: install ola";
  try {
    sacn::Receiver(":5568", std::vector<uint32_t>{});
  } catch (const Error& error) {
    GTEST_SKIP() << "olad needs this port: " << error.what();
  }
  Olad olad;
  ASSERT_TRUE(olad.listen(1)) << olad.log();
  ASSERT_TRUE(olad.listen(2)) << olad.log();

  // 331 lights fill one universe and most of a second one.
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

  LightDriverSettings settings;
  settings.backend = LightDriverSettings::Backend::sacn;
  settings.sacn.destination = "127.0.0.1";
  const auto driver = make_light_driver(settings);
  driver->upload(program);
  const DmxPatch patch(program, 1);
  const auto expect_shown = [&](uint64_t trigger) {
    for (const auto& [universe, levels] : patch.levels(program.colors(program.at(trigger)))) {
      const std::vector<int> expected(levels.begin(), levels.end());
      std::vector<int> heard;
      for (int i = 0; i < 50 && heard != expected; ++i) {
        std::this_thread::sleep_for(milliseconds(20));
        heard = olad.levels(universe);
      }
      EXPECT_EQ(heard, expected) << "trigger " << trigger << " universe " << universe << "\n"
                                 << olad.log();
    }
  };
  for (uint64_t t = 0; t <= program.steps.size(); ++t) {
    driver->show(t);
    expect_shown(t);
  }
}

}  // namespace
}  // namespace inverse::testing
