#include "sync_params.hpp"

#include <cstdint>

namespace inverse {
namespace {

/// A field of the lights' settings.
template <typename Get>
auto lights(Get get) {
  return [get](SyncParams & params) -> auto& { return get(params.lights); };
}

}  // namespace

const PropertyTable<SyncParams>& sync_properties() {
  using P = SyncParams;
  const auto value = [](auto choice) { return static_cast<int>(choice); };
  static const PropertyTable<P> table{
      text<P>(
          "program", &P::program,
          "The light program: a JSON file, or \"performance\" or \"static\", also with a number "
          "of lights as \"static:96\"",
          Mutable::ready),
      choice<P>(
          "frame-id", &P::frame_id, "GstInverseFrameId",
          {{value(P::FrameId::none), "none", "Time stamps alone tell which trigger a frame is of"},
           {value(P::FrameId::offset), "offset",
            "GST_BUFFER_OFFSET is the number that the camera gave the frame (v4l2src); it "
            "counts, and time stamps check"}},
          "Where the camera's frame id is", Mutable::ready),
      choice<P>("frame-id-bits", &P::frame_id_bits, "GstInverseFrameIdBits",
                {{16, "16", "Ids wrap after 65535"},
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
      number<P>("max-frames", &P::max_frames, 8u, 1024u,
                "Frames of a camera that wait for other cameras' at most", Mutable::ready),
      flag<P>("drop-unlabeled", &P::drop_unlabeled,
              "Drop frames that cannot be labeled; else they pass without a light stage meta",
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
      choice<P>(
          "camera-trigger", &P::camera_trigger, "GstInverseCameraTrigger",
          {{value(P::CameraTrigger::none), "none",
            "Cameras and lights are stepped by the rig; frames are labeled by time and marker"},
           {value(P::CameraTrigger::aravis_software), "aravis-software",
            "This element steps the lights, then fires the software trigger of every camera "
            "upstream (lightstagearavissrc, aravissrc), waits for that frame, and so on"}},
          "Who triggers the cameras", Mutable::ready),
      number<P>("trigger-timeout", &P::trigger_timeout, 0.01, 60,
                "Seconds in which the frame of a trigger has to come (camera-trigger)",
                Mutable::ready),
      number<P>(
          "trigger-retries", &P::trigger_retries, 0u, 100u,
          "How often a camera whose frame does not come is triggered again in the same light; "
          "then the step is dropped with a warning (camera-trigger)",
          Mutable::ready),
      choice<P>(
          "lights", lights([](auto& l) -> auto& { return l.backend; }), "GstInverseLights",
          {{value(LightDriverSettings::Backend::none), "none",
            "The lights are not driven: the rig has the program already"},
           {value(LightDriverSettings::Backend::sacn), "sacn", "Streaming ACN (E1.31) over UDP"},
           {value(LightDriverSettings::Backend::serial), "serial",
            "A controller on a serial line, which keeps the program and is stepped"}},
          "How the lights are reached (with camera-trigger)", Mutable::ready),
      text<P>("sacn-destination", lights([](auto& l) -> auto& { return l.sacn.destination; }),
              "Receiver of lights=sacn, \"host\" or \"host:port\"; empty: multicast",
              Mutable::ready),
      text<P>("sacn-interface", lights([](auto& l) -> auto& { return l.sacn.interface_address; }),
              "IPv4 address of the network interface for multicast; empty: the system's choice",
              Mutable::ready),
      number<P>("sacn-universe", lights([](auto& l) -> auto& { return l.sacn.universe; }), 1u,
                63999u, "Universe in which the program's channel 1 is", Mutable::ready),
      number<P>("sacn-sync-universe", lights([](auto& l) -> auto& { return l.sacn.sync_universe; }),
                0u, 63999u, "Universe of the synchronization packets; 0: there are none",
                Mutable::ready),
      number<P>("sacn-priority", lights([](auto& l) -> auto& { return l.sacn.priority; }), 0u, 200u,
                "Priority among several sources", Mutable::ready),
      text<P>("serial-port", lights([](auto& l) -> auto& { return l.serial.port; }),
              "Serial line of lights=serial, such as /dev/ttyUSB0", Mutable::ready),
      number<P>("serial-baud", lights([](auto& l) -> auto& { return l.serial.baud; }), 9600u,
                4000000u, "Its bits a second", Mutable::ready),
      text<P>(
          "device", &P::device,
          "Vulkan device for layers (assemble=pairs): an index or a part of its name; empty = "
          "shared with neighbors, else the environment variable INVERSE_DEVICE, else the fastest",
          Mutable::ready),
  };
  return table;
}

}  // namespace inverse
