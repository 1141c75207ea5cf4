// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sync_params.hpp"

namespace inverse {

const PropertyTable<SyncParams>& sync_properties() {
  using P = SyncParams;
  using Backend = LightDriverSettings::Backend;
  const auto value = [](auto choice) { return static_cast<int>(choice); };
  static const PropertyTable<P> table{
      text<P>("program", &P::program,
              "Light program: a JSON file, or performance[:N] or static[:N] for N lights",
              Mutable::ready),
      number<P>("rate", &P::rate, 1u, 1000u, "Steps per second of performance and static programs",
                Mutable::ready),
      choice<P>("frame-id", &P::frame_id, "GstInverseFrameId",
                {{value(P::FrameId::none), "none", "None: labels follow from time stamps alone"},
                 {value(P::FrameId::offset), "offset",
                  "GST_BUFFER_OFFSET (v4l2src, lightstagearavissrc), checked against time stamps"}},
                "Source of the camera's frame id", Mutable::ready),
      tuning(choice<P>("frame-id-bits", &P::frame_id_bits, "GstInverseFrameIdBits",
                       {{0, "auto", "Value of the upstream source, else 64"},
                        {16, "16", "Ids wrap after 65535"},
                        {32, "32", "Ids wrap after 4294967295"},
                        {64, "64", "Ids wrap after 2^64 - 1"}},
                       "Bits of a frame id, after which it starts again at 0 or 1",
                       Mutable::ready)),
      tuning(
          number<P>("jitter", &P::jitter, 0.01, 0.45,
                    "Maximum deviation of a time stamp from its trigger, in periods of the program",
                    Mutable::ready)),
      tuning(number<P>("marker-timeout", &P::marker_timeout, 0.1, 3600,
                       "Seconds without the marker (black, full, black) before a warning",
                       Mutable::ready)),
      choice<P>("sets", &P::sets, "GstInverseSets",
                {{value(P::Sets::complete), "complete",
                  "Only frames of triggers for which every camera sent one"},
                 {value(P::Sets::all), "all", "All labeled frames"}},
                "Which sets of frames of several cameras pass", Mutable::ready),
      number<P>("timeout", &P::timeout, 0.01, 60,
                "Seconds without frames of a camera after which others continue without it",
                Mutable::ready),
      tuning(number<P>("max-frames", &P::max_frames, 0u, 1024u,
                       "Maximum number of waiting frames per camera; 0 = by timeout, up to 1 GiB",
                       Mutable::ready)),
      tuning(flag<P>("drop-unlabeled", &P::drop_unlabeled,
                     "Drop frames without a label instead of passing them; for assemble=none",
                     Mutable::ready)),
      choice<P>(
          "assemble", &P::assemble, "GstInverseAssemble",
          {{value(P::Assemble::none), "none", "Frames pass as they are, with their labels"},
           {value(P::Assemble::pairs), "pairs",
            "Gradients A and B in one buffer: as layers if the next element takes them, else side "
            "by side"},
           {value(P::Assemble::olat), "olat",
            "Frames of a static capture, moved to the subject's place in the last tracking frame"}},
          "How to combine labeled frames", Mutable::ready),
      choice<P>("align", &P::align, "GstInverseAlign",
                {{value(P::Align::none), "none", "B as it was seen, one trigger after A"},
                 {value(P::Align::flow), "flow",
                  "B moved to where the subject was in A, by optical flow"}},
                "Alignment of the two frames of a pair (assemble=pairs)", Mutable::ready),
      text<P>("location", &P::location,
              "Folder for the OpenEXR files of a static capture (assemble=olat); empty = none",
              Mutable::ready),
      text<P>("device", &P::device,
              "Vulkan device for layers: an index or a part of its name; empty = shared, else "
              "INVERSE_DEVICE, else the fastest",
              Mutable::ready),
      choice<P>(
          "camera-trigger", &P::camera_trigger, "GstInverseCameraTrigger",
          {{value(P::CameraTrigger::none), "none",
            "The rig or the cameras' own clocks; labels follow from time and marker"},
           {value(P::CameraTrigger::aravis_software), "aravis-software",
            "For each step of the lights this element triggers every camera upstream and waits "
            "for the frames"}},
          "Trigger of the cameras", Mutable::ready),
      tuning(number<P>("trigger-timeout", &P::trigger_timeout, 0.01, 60,
                       "camera-trigger=aravis-software: seconds to wait for the frame of a trigger",
                       Mutable::ready)),
      tuning(number<P>("trigger-retries", &P::trigger_retries, 0u, 100u,
                       "camera-trigger=aravis-software: repeated triggers before a step is dropped",
                       Mutable::ready)),
      choice<P>(
          "backend", [](P & p) -> auto& { return p.lights.backend; }, "GstInverseLightBackend",
          {{value(Backend::none), "none", "The rig runs the program by itself"},
           {value(Backend::sacn), "sacn",
            "Streaming ACN (E1.31) over UDP, stepped by the pipeline's clock"},
           {value(Backend::ola), "ola",
            "olad of the Open Lighting Architecture on this machine, stepped by the pipeline's "
            "clock"},
           {value(Backend::serial), "serial",
            "A controller on a serial line, which gets the program at the start and a pulse per "
            "step"}},
          "Protocol to control the lights", Mutable::ready),
      tuning(number<P>("lead-in", &P::lead_in, 0, 3600,
                       "Minimum seconds of black from PLAYING to the program's start",
                       Mutable::ready)),
      text<P>(
          "host", [](P & p) -> auto& { return p.lights.sacn.destination; },
          "Receiver as host or host:port (backend=sacn); empty = multicast", Mutable::ready),
      tuning(text<P>(
          "interface", [](P & p) -> auto& { return p.lights.sacn.interface_address; },
          "backend=sacn: IPv4 address of the network interface for multicast; empty = chosen by "
          "the system",
          Mutable::ready)),
      number<P>(
          "universe", [](P & p) -> auto& { return p.lights.dmx.universe; }, 1u, 63999u,
          "Universe of the program's channel 1 (backend=sacn, ola)", Mutable::ready),
      tuning(number<P>(
          "sync-universe", [](P & p) -> auto& { return p.lights.sacn.sync_universe; }, 0u, 63999u,
          "backend=sacn: universe of synchronization packets; 0 = none", Mutable::ready)),
      tuning(number<P>(
          "priority", [](P & p) -> auto& { return p.lights.dmx.priority; }, 0u, 200u,
          "backend=sacn, ola: priority over other senders", Mutable::ready)),
      tuning(number<P>(
          "ola-port", [](P & p) -> auto& { return p.lights.ola.port; }, 1u, 65535u,
          "backend=ola: TCP port of olad", Mutable::ready)),
      text<P>(
          "serial-port", [](P & p) -> auto& { return p.lights.serial.port; },
          "Serial port, such as /dev/ttyUSB0 (backend=serial)", Mutable::ready),
      tuning(number<P>(
          "baud", [](P & p) -> auto& { return p.lights.serial.baud; }, 9600u, 3000000u,
          "backend=serial: speed, bits per second", Mutable::ready)),
      tuning(flag<P>(
          "pulses", [](P & p) -> auto& { return p.lights.serial.pulses; },
          "backend=serial: step the program from here; false = the rig's own trigger does",
          Mutable::ready)),
      tuning(number<P>(
          "serial-timeout", [](P & p) -> auto& { return p.lights.serial.timeout; }, 0.01, 3600,
          "backend=serial: seconds to wait for an answer of the controller", Mutable::ready)),
  };
  return table;
}

}  // namespace inverse
