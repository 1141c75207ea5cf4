// SPDX-License-Identifier: LGPL-2.1-or-later
// Lines that begin or end in the network, over loopback.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "pipeline_test.hpp"

namespace inverse::testing {
namespace {

/// An unused UDP port.
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
  static constexpr uintmax_t kSomeFrames = 10 * 160 * 120;  // bytes
};

TEST_F(Network, RtpIn) {
  const std::string port = free_port();
  Process receiver({script("rtp-in"), port}, environment({{"SINK", raw_file(file("in.mkv"))}}));
  Process sender({"bash", "-c",
                  std::string("exec gst-launch-1.0 ") + kCamera +
                      " ! vp8enc deadline=1 keyframe-max-dist=5 ! rtpvp8pay ! udpsink "
                      "host=127.0.0.1 port=" +
                      port});
  end_when_grown(receiver, file("in.mkv"), kSomeFrames, &sender);
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
  end_when_grown(receiver, file("out.mkv"), kSomeFrames, &sender);
  ASSERT_NO_FATAL_FAILURE(expect_video(read_media(file("out.mkv")), 160, 120, 3));
}

}  // namespace
}  // namespace inverse::testing
