// Lines that begin or end in the network, over loopback.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <thread>

#include "pipeline_test.hpp"

namespace inverse::testing {
namespace {

/// A UDP port that nobody uses now.
std::string free_port() {
  const int descriptor = socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  bind(descriptor, reinterpret_cast<sockaddr*>(&address), size);
  getsockname(descriptor, reinterpret_cast<sockaddr*>(&address), &size);
  close(descriptor);
  return std::to_string(ntohs(address.sin_port));
}

constexpr const char* kCamera =
    "videotestsrc is-live=true ! video/x-raw,width=160,height=120,framerate=10/1";

class Network : public PipelineTest {
 protected:
  /// Lets a receiver write `path` until it has grown, then ends it as Ctrl-C does.
  void receive(Process& receiver, Process& sender, const std::string& path) {
    for (int i = 0; i < 600; ++i) {
      std::error_code code;
      if (std::filesystem::file_size(path, code) > 10 * 160 * 120 && !code) break;
      ASSERT_TRUE(receiver.running()) << receiver.output();
      ASSERT_TRUE(sender.running()) << sender.output();
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    receiver.interrupt();
    EXPECT_EQ(receiver.wait(30), 0) << receiver.output();
  }
};

TEST_F(Network, RtpIn) {
  const std::string port = free_port();
  Process receiver({script("rtp-in"), port}, environment({{"SINK", raw_file(file("in.mkv"))}}));
  Process sender({"bash", "-c",
                  std::string("exec gst-launch-1.0 ") + kCamera +
                      " ! vp8enc deadline=1 keyframe-max-dist=5 ! rtpvp8pay ! udpsink "
                      "host=127.0.0.1 port=" +
                      port});
  receive(receiver, sender, file("in.mkv"));
  const Media media = read_media(file("in.mkv"));
  ASSERT_NO_FATAL_FAILURE(expect_video(media, 160, 120, 3));
  expect_mosaic(media.frames.back());
}

TEST_F(Network, RtpOut) {
  const std::string port = free_port();
  Process sender({script("rtp-out"), "unused", "127.0.0.1", port},
                 environment({{"SOURCE", std::string(kCamera) + " ! queue"}}));
  Process receiver({"bash", "-c",
                    "exec gst-launch-1.0 -e udpsrc port=" + port +
                        " ! application/x-rtp,media=video,encoding-name=VP8,payload=96,"
                        "clock-rate=90000 ! rtpvp8depay ! vp8dec ! " +
                        raw_file(file("out.mkv"))});
  receive(receiver, sender, file("out.mkv"));
  ASSERT_NO_FATAL_FAILURE(expect_video(read_media(file("out.mkv")), 160, 120, 3));
}

}  // namespace
}  // namespace inverse::testing
