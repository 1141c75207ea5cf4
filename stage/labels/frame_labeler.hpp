#pragma once
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "light_evidence.hpp"
#include "stage/program/light_program.hpp"
#include "trigger_counter.hpp"

namespace inverse {

/// Says of each frame of one camera which step of a light program lit it
/// (docs/reference/light-stage-labels.md).
///
/// Triggers are counted by TriggerCounter. Where the program began is read from the pictures: its
/// marker is black, full on, black, each a frame long. From then on pictures only check: who
/// contradicts the label that times give is dropped, and where that goes on all labels are off
/// until the next marker. Pictures of single lights tell nothing, so these frames wait until the
/// next one comes that does: a tracking frame, or one of a gradient.
class FrameLabeler {
 public:
  struct Params {
    double jitter = 0.34;      ///< of time stamps, either way, in periods of the program
    double drift = 250;        ///< of the camera's clock against the program's, ppm
    uint32_t id_bits = 0;      ///< of the frame ids: 16, 32, 64, or 0 where there are none
    double marker_within = 5;  ///< seconds after which a marker that has not come is told
    uint32_t hold = 24;        ///< frames that may wait for what later ones tell
  };
  struct Frame {
    uint64_t token = 0;           ///< the caller's name for it
    std::optional<int64_t> time;  ///< PTS, ns
    std::optional<uint64_t> id;   ///< of the camera
    ImageEvidence image;
  };
  enum class Fate : uint8_t {
    labeled,
    duplicate,      ///< another of its trigger was there already
    late,           ///< after one of a later trigger, or stamped too late to tell
    ambiguous,      ///< which of two triggers was not told by what came with it and after it
    contradicted,   ///< times say one step, the picture another
    before_marker,  ///< the program has not started yet, or where it is is not known any more
    ended,          ///< all of the program has been
    untimed,        ///< neither a time nor an id
  };
  /// Where another camera has the program: for markers before every pass, which do not tell how
  /// many passes were before them.
  struct Running {
    int64_t time = 0;      ///< by this camera's PTS, ns, of the frame of
    uint64_t trigger = 0;  ///< the program's
    uint64_t run = 0;      ///< the caller's name for this start of the program
    bool ours = false;     ///< this camera has counted from that start, too
  };
  /// From where triggers are counted.
  struct Start {
    uint64_t number = 0;          ///< another one for another start
    std::optional<uint64_t> run;  ///< whose count is gone on with
    bool apart = false;  ///< one was told of, and how many passes lie between is not certain
  };
  struct Labeled {
    uint64_t token = 0;
    Fate fate = Fate::before_marker;
    uint64_t trigger = 0;  ///< of the program; of `labeled` frames
    LightProgram::Position position;
    Start start{};  ///< of `labeled` frames
  };
  struct Counts {
    uint64_t frames = 0, labeled = 0;
    uint64_t missing = 0;  ///< triggers without a frame, between the first label and the last
    uint64_t duplicates = 0, late = 0, ambiguous = 0, contradicted = 0;
    uint64_t before_marker = 0, ended = 0, untimed = 0;
    uint64_t markers = 0;             ///< that were seen
    uint64_t resynchronizations = 0;  ///< times the labels were lost, and counts that began anew
  };

  /// `program` has to outlive it.
  FrameLabeler(const LightProgram& program, const Params& params);

  /// Takes the next frame as it arrives; returns those that are settled by it, in their order but
  /// for such that are dropped at once.
  std::vector<Labeled> push(const Frame& frame, const std::optional<Running>& running = {});
  /// Nothing more comes: those that are held.
  std::vector<Labeled> drain();
  /// All that is held is forgotten; what is known of the clock and the program's start is not.
  void flush();
  /// Starts as new, but counts go on. What is held is forgotten: `drain` tells it before.
  void reset();

  /// The next frames show the subject in another size or frame: the count goes on, and what they
  /// are compared with is found anew. Returns what was held for pictures like those before.
  std::vector<Labeled> new_framing();

  /// How many periods a frame of the program may wait for the one that confirms it, where one of
  /// these is lost, too.
  static uint32_t longest_wait(const LightProgram& program, const Params& params);
  /// Whether single lights wait long enough to be confirmed by pictures.
  static bool all_confirmed(const LightProgram& program, const Params& params);
  bool anchored() const { return anchor_.has_value(); }
  const Start& start() const { return start_; }
  /// Whether the marker has not come within `Params::marker_within`; once for each time that it is
  /// waited for.
  bool take_overdue();
  const Counts& counts() const { return counts_; }
  /// Rate of the triggers in Hz by the camera's clock: as sure as that is, from and to.
  std::pair<double, double> rate() const;
  const LightEvidence& evidence() const { return evidence_; }

 private:
  /// A frame whose trigger (of the counter's) is certain, while the marker is looked for.
  struct Seen {
    uint64_t token;
    int64_t trigger;
    ImageEvidence image;
    bool told;
    std::optional<int64_t> time;  ///< ns
  };
  /// A frame in the counter.
  struct Waiting {
    uint64_t token;
    ImageEvidence image;
    std::optional<int64_t> time;
  };
  /// A frame that waits to be told.
  struct Unconfirmed {
    Labeled frame;
    uint64_t missing = 0;  ///< counts_.missing before it
  };
  struct Unsettled {
    std::deque<Unconfirmed> frames;  ///< oldest first
    size_t confirmed = 0;  ///< of these, from the oldest on: they wait for `suspected` only
    bool doubted = false;  ///< the last was labeled just now; the next frame may claim its trigger
    std::optional<int64_t>
        suspected;  ///< (the counter's) first trigger of what may be a new marker
  };
  struct Anchor {
    int64_t trigger = 0;  ///< of the counter's: the program's 0
    double black = 0, full = 0;
    bool clipped = false;
  };
  std::vector<Labeled> settle(const std::vector<TriggerCounter::Counted>& counted);
  void counted(const TriggerCounter::Counted& frame, const Waiting& waiting,
               std::vector<Labeled>& out);
  void label(uint64_t token, int64_t trigger, const ImageEvidence& image,
             std::vector<Labeled>& out);
  void tell(uint64_t token, Fate fate, std::vector<Labeled>& out);
  Fate outside() const { return over_ ? Fate::ended : Fate::before_marker; }
  bool contradicts(int64_t trigger, const ImageEvidence& image) const;
  void tell_all_seen(std::vector<Labeled>& out);
  void look_for_marker(std::vector<Labeled>& out);
  bool begins_pass(int64_t trigger) const;
  std::optional<int64_t> start_of_running(int64_t marker) const;
  int64_t start_of(int64_t marker);
  void take_anchor(const Anchor& anchor, std::vector<Labeled>& out);
  void lose_anchor();
  void end();
  bool is_weak(LightProgram::Position position) const;
  bool told_by_neighbors(LightProgram::Position position) const;
  // Frames that wait to be confirmed: frame_labeler_waiting.cpp.
  bool confirmable() const;
  void wait(const Unconfirmed& one, std::vector<Labeled>& out);
  void release(size_t count, std::vector<Labeled>& out);
  void release_confirmed(std::vector<Labeled>& out);
  void revoke();
  void end_of_evidence(std::vector<Labeled>& out);
  bool check_follows(LightProgram::Position position) const;
  void mark_told(uint64_t token, bool told);
  uint64_t& count_of(Fate fate);
  /// Triggers that a marker and what has to follow it may take to be found.
  int64_t longest_search() const { return int64_t{params_.hold} + LightProgram::kMarkerSteps; }
  bool late_tracking_frame(int64_t trigger) const;
  void look_at_suspicion(std::vector<Labeled>& out);
  const Seen* seen_at(int64_t trigger) const;
  enum class Match : uint8_t { no, wait, yes };
  Match matches(int64_t start, Anchor& anchor) const;
  std::optional<Anchor> without_full_frame(int64_t start) const;
  Match told_by_tracking(int64_t start, Anchor& anchor) const;
  bool may_be_tracking(const Seen& full, const Anchor& anchor) const;
  Match follows(const Anchor& anchor, uint32_t wanted) const;

  const LightProgram& program_;
  Params params_;
  double period_;  // ns
  TriggerCounter counter_;
  LightEvidence evidence_;
  Counts counts_;
  std::deque<Waiting> waiting_;
  std::optional<int64_t> origin_;  // ns
  std::optional<Running> running_;
  Start start_;
  std::optional<int64_t> anchor_;
  std::optional<int64_t> lost_anchor_;   // of this epoch, and of a program that has not ended
  std::optional<int64_t> found_marker_;  // the counter's: where the last anchor was taken
  bool begun_ = false;                   // without a marker only the first frame is the start
  uint64_t epoch_ = 0;
  bool ended_ = false;  // just now
  bool over_ = false;   // it has ended, and no marker was seen since
  std::deque<Seen> seen_;
  std::optional<int64_t> last_;      // the counter's trigger of the last labeled frame
  uint64_t dropped_since_last_ = 0;  // which took a trigger's place and were not labeled
  ImageEvidence before_;             // of the frame that came before
  Unsettled unsettled_;
  std::optional<int64_t> trouble_;          // the counter's: where a frame of no trigger was last
  std::optional<int64_t> confirmed_until_;  // the counter's trigger: no marker was before it
  uint32_t contradicted_lately_ = 0;
  std::optional<int64_t> waiting_since_, now_;  // ns
  bool overdue_told_ = false;
};

}  // namespace inverse
