#include "sync_params.hpp"

namespace inverse {

const PropertyTable<SyncParams>& sync_properties() {
  using P = SyncParams;
  using Backend = LightDriverSettings::Backend;
  const auto value = [](auto choice) { return static_cast<int>(choice); };
  static const PropertyTable<P> table{
      text<P>(
          "program", &P::program,
          "The light program: a JSON file, or \"performance\" or \"static\", also with a number "
          "of lights as \"static:96\"",
          Mutable::ready),
      number<P>("rate", &P::rate, 1u, 1000u,
                "Steps a second of programs that are no files (these have a rate of their own): "
                "that of the cameras",
                Mutable::ready),
      choice<P>(
          "frame-id", &P::frame_id, "GstInverseFrameId",
          {{value(P::FrameId::none), "none", "Time stamps alone tell which trigger a frame is of"},
           {value(P::FrameId::offset), "offset",
            "GST_BUFFER_OFFSET is the number that the camera gave the frame (v4l2src); it "
            "counts, and time stamps check"}},
          "Where the camera's frame id is", Mutable::ready),
      choice<P>(
          "frame-id-bits", &P::frame_id_bits, "GstInverseFrameIdBits",
          {{0, "auto",
            "As an element upstream says that has this property (lightstagearavissrc); else 64"},
           {16, "16", "Ids wrap after 65535"},
           {32, "32", "Ids wrap after 4294967295"},
           {64, "64", "Ids wrap after 2^64 - 1"}},
          "Bits of a frame id; after the largest comes 0, or 1 where the camera leaves 0 out",
          Mutable::ready),
      number<P>(
          "jitter", &P::jitter, 0.01, 0.45,
          "How far a time stamp may be from its trigger's time, either way, in periods of the "
          "program; labels are certain as long as this holds",
          Mutable::ready),
      number<P>("marker-timeout", &P::marker_timeout, 0.1, 3600,
                "Seconds of a camera's frames without the marker (black, full, black) after which "
                "there is a warning",
                Mutable::ready),
      choice<P>("sets", &P::sets, "GstInverseSets",
                {{value(P::Sets::complete), "complete",
                  "Only frames of triggers that every camera has sent a frame of"},
                 {value(P::Sets::all), "all", "All labeled frames"}},
                "Which frames pass where there are several cameras", Mutable::ready),
      number<P>("timeout", &P::timeout, 0.01, 60,
                "Seconds for which frames wait for a camera that has stopped; then there is a "
                "warning, and the others go on without it",
                Mutable::ready),
      number<P>("max-frames", &P::max_frames, 0u, 1024u,
                "Frames of a camera that wait for other cameras' at most; 0: as many as come while "
                "another camera is waited for (46 at 60 Hz with the default timeout), up to 1 GiB. "
                "Fewer hold up live cameras, which then lose frames",
                Mutable::ready),
      flag<P>("drop-unlabeled", &P::drop_unlabeled,
              "Drop frames that cannot be labeled; else they pass without a light stage meta. No "
              "effect with assemble=pairs and olat: what they make takes labeled frames alone",
              Mutable::ready),
      choice<P>("assemble", &P::assemble, "GstInverseAssemble",
                {{value(P::Assemble::none), "none", "Frames pass as they are, with their labels"},
                 {value(P::Assemble::pairs), "pairs",
                  "Gradients A and B of a performance in one buffer: layers where the next element "
                  "takes them, else one picture with A at the left and B at the right"},
                 {value(P::Assemble::olat), "olat",
                  "Frames of a static capture, each moved to where the subject was in its last "
                  "tracking frame, once that has come"}},
                "What becomes of labeled frames", Mutable::ready),
      choice<P>("align", &P::align, "GstInverseAlign",
                {{value(P::Align::none), "none", "B as it was seen, one trigger after A"},
                 {value(P::Align::flow), "flow",
                  "B moved to where the subject was in A, by optical flow"}},
                "How a pair is put together (assemble=pairs)", Mutable::ready),
      text<P>("location", &P::location,
              "Folder for the frames of a static capture as half-float OpenEXR files, and a JSON "
              "file that lists them with directions (assemble=olat); empty: none",
              Mutable::ready),
      text<P>(
          "device", &P::device,
          "Vulkan device for layers (assemble=pairs): an index or a part of its name; empty = "
          "shared with neighbors, else the environment variable INVERSE_DEVICE, else the fastest",
          Mutable::ready),
      choice<P>("camera-trigger", &P::camera_trigger, "GstInverseCameraTrigger",
                {{value(P::CameraTrigger::none), "none",
                  "Something else: the rig, or their own clocks. Frames are labeled by time and "
                  "marker"},
                 {value(P::CameraTrigger::aravis_software), "aravis-software",
                  "This element steps the lights, then fires the software trigger of every camera "
                  "upstream (lightstagearavissrc, aravissrc), waits for these frames, and so on"}},
                "What triggers the cameras", Mutable::ready),
      number<P>(
          "trigger-timeout", &P::trigger_timeout, 0.01, 60,
          "camera-trigger=aravis-software: seconds in which the frame of a trigger has to come",
          Mutable::ready),
      number<P>("trigger-retries", &P::trigger_retries, 0u, 100u,
                "camera-trigger=aravis-software: how often a camera whose frame does not come is "
                "triggered again in the same light; then the step is dropped with a warning",
                Mutable::ready),
      choice<P>(
          "backend", [](P & p) -> auto& { return p.lights.backend; }, "GstInverseLightBackend",
          {{value(Backend::none), "none", "The rig has the program, and its own trigger steps it"},
           {value(Backend::sacn), "sacn",
            "Streaming ACN (E1.31) over UDP, stepped by the pipeline's clock"},
           {value(Backend::ola), "ola",
            "olad of the Open Lighting Architecture, on this machine, which has the hardware; "
            "stepped by the pipeline's clock"},
           {value(Backend::serial), "serial",
            "A controller on a serial line that is given the program before the start, and a "
            "pulse for each step"}},
          "How the lights are reached", Mutable::ready),
      number<P>(
          "lead-in", &P::lead_in, 0, 3600,
          "Seconds of black at least from PLAYING to the program's start, where the lights are "
          "driven from here; it starts at a whole number of periods of the running time",
          Mutable::ready),
      text<P>(
          "host", [](P & p) -> auto& { return p.lights.sacn.destination; },
          "backend=sacn: the one receiver, host or host:port; empty: multicast, to the group of "
          "each universe",
          Mutable::ready),
      text<P>(
          "interface", [](P & p) -> auto& { return p.lights.sacn.interface_address; },
          "backend=sacn: IPv4 address of the network interface for multicast; empty: the "
          "system's choice",
          Mutable::ready),
      number<P>(
          "universe", [](P & p) -> auto& { return p.lights.dmx.universe; }, 1u, 63999u,
          "backend=sacn, ola: the universe in which the program's channel 1 is", Mutable::ready),
      number<P>(
          "sync-universe", [](P & p) -> auto& { return p.lights.sacn.sync_universe; }, 0u, 63999u,
          "backend=sacn: universe of the packets that make all receivers change at once; 0: "
          "none",
          Mutable::ready),
      number<P>(
          "priority", [](P & p) -> auto& { return p.lights.dmx.priority; }, 0u, 200u,
          "backend=sacn, ola: priority over other senders", Mutable::ready),
      number<P>(
          "ola-port", [](P & p) -> auto& { return p.lights.ola.port; }, 1u, 65535u,
          "backend=ola: the port on which olad answers", Mutable::ready),
      text<P>(
          "serial-port", [](P & p) -> auto& { return p.lights.serial.port; },
          "backend=serial: the port, such as /dev/ttyUSB0", Mutable::ready),
      number<P>(
          "baud", [](P & p) -> auto& { return p.lights.serial.baud; }, 9600u, 3000000u,
          "backend=serial: its speed, bits a second", Mutable::ready),
      flag<P>(
          "pulses", [](P & p) -> auto& { return p.lights.serial.pulses; },
          "backend=serial: step the program from here; else the rig's own trigger does",
          Mutable::ready),
      number<P>(
          "patience", [](P & p) -> auto& { return p.lights.serial.timeout; }, 0.01, 3600,
          "backend=serial: seconds that the controller has for an answer", Mutable::ready),
  };
  return table;
}

}  // namespace inverse
