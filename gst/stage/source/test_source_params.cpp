#include "test_source_params.hpp"

namespace inverse {

const PropertyTable<TestSourceParams>& test_source_properties() {
  using P = TestSourceParams;
  constexpr Mutable kReady = Mutable::ready;
  static const PropertyTable<P> table{
      text<P>("program", &P::program,
              "What the lights do: a file of a light program, performance or static; "
              "performance:96 is with 96 lights instead of 331",
              kReady),
      number<P>("rate", &P::rate, 1, 1000,
                "Frames a second of programs that are no files (these have a rate of their own)",
                kReady),
      number<P>("start", &P::start, 0, 1e6,
                "Running time at which the program starts, seconds, rounded to its periods; frames "
                "before it are black, and a live camera that is not ready by then misses the "
                "beginning. Several cameras need the same one. 0: with the first frame",
                kReady),
      text<P>("location", &P::location,
              "A folder of OLAT images to play in place of the head: lights.json and olat/NNN.exr. "
              "The frames have the images' size",
              kReady),
      text<P>("listen", &P::listen,
              "Lights follow the sACN (E1.31) packets that come to this host:port, such as :5568, "
              "in place of the program's steps; where its lights and their channels are still says "
              "the program. Empty: nothing is heard",
              kReady),
      tuning(number<P>("universe", &P::universe, 1, 63999,
                       "With listen: the sACN universe that channel 1 is in", kReady)),
      tuning(number<P>(
          "sync-universe", &P::sync_universe, 0, 63999,
          "With listen: the universe of synchronization packets, whose multicast group is "
          "joined, too; 0: none",
          kReady)),
      number<P>("camera", &P::camera, 0, 15,
                "From where the head is seen: 0 from the front, 1, 3, … 20 degrees each farther to "
                "its left (the right of the picture), 2, 4, … to its right. Directions of lights "
                "are as camera 0 sees them",
                kReady),
      tuning(number<P>(
          "stack-limit", &P::stack_limit, 1, 1048576,
          "MiB that the images under one light each may take on the device: 8 bytes a pixel "
          "and light",
          kReady)),
      flag<P>(
          "label", &P::label,
          "Attach GstLightStageMeta with what lit each frame: for tests, as real cameras do not "
          "know",
          kReady),
      flag<P>(
          "frame-ids", &P::frame_ids,
          "Write the camera's frame number into the buffer's offset; dropped frames leave gaps, "
          "doubled ones have the same",
          kReady),
      tuning(number<P>("first-frame-id", &P::first_frame_id, 0, 0xffffffffU,
                       "The first frame's number", kReady)),
      choice<P>("frame-id-bits", &P::frame_id_bits, "GstInverseTestSourceIdBits",
                {{16, "16", "Numbers go from 65535 to 1, as those of GigE Vision cameras"},
                 {64, "64", "Numbers do not wrap"}},
                "How wide frame numbers are", kReady),
      number<P>("seed", &P::seed, 0, 0xffffffffU,
                "Of noise and of what goes wrong: the same seed does the same", kReady),
      number<P>("gain", &P::gain, 0, 10000,
                "Factor on light; at 1 white paper is white (1) with all lights on, so that one "
                "light alone is dim: a quarter of the number of lights makes it as bright. Of a "
                "capture of lightstagesync the brightest hundredth is white with all lights on"),
      number<P>("noise", &P::noise, 0, 1,
                "Standard deviation of the camera's noise at white, as a part of white; its square "
                "grows with light, a tenth of it is there without"),
      number<P>("motion", &P::motion, -1000, 1000,
                "How far the top row of the picture sways, pixels to either side; the bottom row "
                "stands still, those between move in proportion"),
      tuning(number<P>("motion-period", &P::motion_period, 0.01F, 3600, "Seconds of a sway")),
      tuning(number<P>("drop-rate", &P::drop_rate, 0, 1, "Share of frames that are lost")),
      tuning(number<P>("duplicate-rate", &P::duplicate_rate, 0, 1,
                       "Share of frames that come twice, with the same time stamp")),
      tuning(number<P>("late-rate", &P::late_rate, 0, 1,
                       "Share of frames whose time stamp is half a period to a period late")),
      tuning(number<P>("jitter", &P::jitter, 0, 0.5F,
                       "Time stamps are off by so much of a period at most, either way")),
  };
  return table;
}

}  // namespace inverse
