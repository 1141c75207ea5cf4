// SPDX-License-Identifier: LGPL-2.1-or-later
#include "test_source_params.hpp"

namespace inverse {

const PropertyTable<TestSourceParams>& test_source_properties() {
  using P = TestSourceParams;
  constexpr Mutable kReady = Mutable::ready;
  static const PropertyTable<P> table{
      text<P>("device", &P::device,
              "Vulkan device: an index or a part of its name; empty = INVERSE_DEVICE, else the "
              "fastest",
              kReady),
      flag<P>("is-live", &P::live,
              "Produce frames at the program's times, as a camera does; false = as fast as "
              "possible",
              kReady),
      text<P>("program", &P::program,
              "Light program: a JSON file, or performance[:N] or static[:N] for N lights", kReady),
      number<P>("rate", &P::rate, 1, 1000, "Frames per second of performance and static programs",
                kReady),
      number<P>("start", &P::start, 0, 1e6,
                "Running time of the program's start in seconds; equal for several cameras, 0 = "
                "first frame",
                kReady),
      text<P>("location", &P::location,
              "Folder of OLAT images to play instead of the head: lights.json and olat/NNN.exr",
              kReady),
      text<P>("listen", &P::listen,
              "Address:port at which sACN packets set the lights: 0.0.0.0:5568 from the network, "
              ":5568 from this machine; empty = the program's steps do",
              kReady),
      text<P>("listen-source", &P::listen_source,
              "With listen: the only sACN sources to accept, addresses or CIDs with commas "
              "between; empty = any",
              kReady),
      tuning(number<P>("universe", &P::universe, 1, 63999,
                       "With listen: the sACN universe that channel 1 is in", kReady)),
      tuning(number<P>("sync-universe", &P::sync_universe, 0, 63999,
                       "With listen: universe of synchronization packets; 0 = none", kReady)),
      number<P>("camera", &P::camera, 0, 15,
                "Viewpoint: 0 from the front, odd numbers 20 degrees each to one side, even ones "
                "to the other",
                kReady),
      tuning(number<P>(
          "stack-limit", &P::stack_limit, 1, 1048576,
          "Maximum device memory for the images of single lights, MiB; 8 bytes per pixel and light",
          kReady)),
      tuning(flag<P>("label", &P::label, "Attach GstLightStageMeta with the true labels, for tests",
                     kReady)),
      flag<P>("frame-ids", &P::frame_ids, "Write the camera's frame id into the buffer's offset",
              kReady),
      tuning(number<P>("first-frame-id", &P::first_frame_id, 0, 0xffffffffU,
                       "Frame id of the first frame", kReady)),
      choice<P>("frame-id-bits", &P::frame_id_bits, "GstInverseTestSourceIdBits",
                {{16, "16", "Numbers go from 65535 to 1, as those of GigE Vision cameras"},
                 {64, "64", "Numbers do not wrap"}},
                "Bits of frame ids", kReady),
      tuning(number<P>("seed", &P::seed, 0, 0xffffffffU,
                       "Seed of noise and faults; equal seeds repeat them", kReady)),
      number<P>("gain", &P::gain, 0, 10000,
                "Factor on light; at 1, white paper is 1 with all lights on"),
      number<P>("noise", &P::noise, 0, 1,
                "Standard deviation of sensor noise at white, relative to white"),
      number<P>("motion", &P::motion, -1000, 1000,
                "Amplitude of the horizontal motion of the top row, pixels; the bottom row stays"),
      tuning(number<P>("motion-period", &P::motion_period, 0.01F, 3600,
                       "Period of the motion, seconds")),
      tuning(number<P>("drop-rate", &P::drop_rate, 0, 1, "Share of frames that are lost")),
      tuning(number<P>("duplicate-rate", &P::duplicate_rate, 0, 1,
                       "Share of frames that come twice, with the same time stamp")),
      tuning(number<P>("late-rate", &P::late_rate, 0, 1,
                       "Share of frames whose time stamp is half a period to a period late")),
      tuning(
          number<P>("jitter", &P::jitter, 0, 0.5F, "Maximum deviation of time stamps, in periods")),
  };
  return table;
}

}  // namespace inverse
