// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "kernels/lightstage/program/light_program.hpp"
#include "light_evidence.hpp"
#include "trigger_counter.hpp"

namespace inverse {

/// Finds, for each frame of one camera, the step of a light program that lit it
/// (docs/reference/light-stage-labels.md).
///
/// TriggerCounter counts the triggers. The start of the program is found in the images: its marker
/// is black, full on, black, one frame each. After that, images only check the labels that time
/// stamps give: a frame that contradicts its label is dropped, and repeated contradictions end
/// labeling until the next marker. Images of single lights confirm nothing, so these frames wait
/// for the next check frame: a tracking or gradient frame.
class FrameLabeler {
 public:
  struct Params {
    double jitter = 0.34;       ///< max error of time stamps, periods of the program
    double drift = 250;         ///< max rate error of the camera's clock, ppm
    uint32_t id_bits = 0;       ///< of the frame ids: 16, 32, 64; 0: no ids
    double marker_timeout = 5;  ///< seconds without a marker before `take_overdue` reports it
    uint32_t hold = 24;         ///< max number of frames that wait for later ones
  };
  struct Frame {
    uint64_t token = 0;           ///< chosen by the caller
    std::optional<int64_t> time;  ///< PTS, ns
    std::optional<uint64_t> id;   ///< of the camera
    ImageEvidence image;
  };
  enum class Fate : uint8_t {
    labeled,
    duplicate,      ///< second frame of its trigger
    late,           ///< after a frame of a later trigger, or stamped too late
    ambiguous,      ///< several triggers fit the frame and those after it
    contradicted,   ///< time stamp and image fit different steps
    before_marker,  ///< before the program's start, or after its position was lost
    ended,          ///< after the end of the program
    untimed,        ///< neither a time nor an id
  };
  /// Position of the program according to another camera. Needed if every pass has a marker: the
  /// marker does not show how many passes came before it.
  struct Running {
    int64_t time = 0;      ///< PTS of this camera, ns, at `trigger`
    uint64_t trigger = 0;  ///< of the program
    uint64_t run = 0;      ///< identifies this start of the program; chosen by the caller
    bool ours = false;     ///< this camera counts from that start, too
  };
  /// The start from which triggers are counted.
  struct Start {
    uint64_t number = 0;          ///< differs between starts
    std::optional<uint64_t> run;  ///< of Running, if its count is continued
    bool apart = false;  ///< Running was given, but the number of passes in between is uncertain
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
    uint64_t markers = 0;             ///< detected
    uint64_t resynchronizations = 0;  ///< losses of the labels or of the count
  };

  /// `program` has to outlive the labeler.
  FrameLabeler(const LightProgram& program, const Params& params);

  /// Adds the next frame in order of arrival. Returns the frames that it decides, in order except
  /// for frames that are dropped at once.
  std::vector<Labeled> push(const Frame& frame, const std::optional<Running>& running = {});
  /// Ends the stream: returns all waiting frames.
  std::vector<Labeled> drain();
  /// Discards waiting frames; keeps the clock and the program's start.
  void flush();
  /// Discards all state except the counts. Call `drain` first to receive waiting frames.
  void reset();

  /// The next frames show the subject at another size or framing: the trigger count goes on, and
  /// reference levels are measured again. Returns frames that waited for images of the old framing.
  std::vector<Labeled> new_framing();

  /// Periods that a frame may wait for the one that confirms it, if one check frame is lost.
  static uint32_t longest_wait(const LightProgram& program, const Params& params);
  /// Whether every single-light frame can wait long enough for a check frame.
  static bool all_confirmed(const LightProgram& program, const Params& params);
  bool anchored() const { return anchor_.has_value(); }
  const Start& start() const { return start_; }
  /// Whether no marker came within `Params::marker_timeout`; true once per search.
  bool take_overdue();
  const Counts& counts() const { return counts_; }
  /// Bounds of the trigger rate by the camera's clock, Hz.
  std::pair<double, double> rate() const;
  const LightEvidence& evidence() const { return evidence_; }

 private:
  /// A recent frame whose trigger (of the counter) is certain.
  struct Seen {
    uint64_t token;
    int64_t trigger;
    ImageEvidence image;
    bool reported;
    std::optional<int64_t> time;  ///< ns
  };
  /// A frame in the counter.
  struct Waiting {
    uint64_t token;
    ImageEvidence image;
    std::optional<int64_t> time;
  };
  /// A frame that waits for confirmation.
  struct Unconfirmed {
    Labeled frame;
    uint64_t missing = 0;  ///< counts_.missing before it
  };
  struct Pending {
    std::deque<Unconfirmed> frames;    ///< oldest first
    size_t confirmed = 0;              ///< the oldest ones, which wait for `suspected` only
    bool uncertain = false;            ///< the next frame may have the trigger of the last one
    std::optional<int64_t> suspected;  ///< counter's first trigger of a possible new marker
  };
  struct Anchor {
    int64_t trigger = 0;  ///< of the counter, at the program's trigger 0
    double black = 0, full = 0;
    bool clipped = false;
  };
  std::vector<Labeled> resolve(const std::vector<TriggerCounter::Counted>& counted);
  void counted(const TriggerCounter::Counted& frame, const Waiting& waiting,
               std::vector<Labeled>& out);
  void label(uint64_t token, int64_t trigger, const ImageEvidence& image,
             std::vector<Labeled>& out);
  void report(uint64_t token, Fate fate, std::vector<Labeled>& out);
  Fate outside() const { return over_ ? Fate::ended : Fate::before_marker; }
  bool contradicts(int64_t trigger, const ImageEvidence& image) const;
  void report_all_seen(std::vector<Labeled>& out);
  void find_marker(std::vector<Labeled>& out);
  bool begins_pass(int64_t trigger) const;
  std::optional<int64_t> start_of_running(int64_t marker) const;
  int64_t start_of(int64_t marker);
  void take_anchor(const Anchor& anchor, std::vector<Labeled>& out);
  void lose_anchor();
  void end();
  bool is_weak(LightProgram::Position position) const;
  bool distinct_from_previous(LightProgram::Position position) const;
  // Frames that wait to be confirmed: frame_labeler_waiting.cpp.
  bool confirmable() const;
  void wait(const Unconfirmed& one, std::vector<Labeled>& out);
  void release(size_t count, std::vector<Labeled>& out);
  void release_confirmed(std::vector<Labeled>& out);
  void revoke();
  void end_of_evidence(std::vector<Labeled>& out);
  bool check_follows(LightProgram::Position position) const;
  void mark_reported(uint64_t token, bool reported);
  uint64_t& count_of(Fate fate);
  /// Max triggers needed to detect a marker and the frames that confirm it.
  int64_t longest_search() const { return int64_t{params_.hold} + LightProgram::kMarkerSteps; }
  bool late_tracking_frame(int64_t trigger) const;
  void check_suspicion(std::vector<Labeled>& out);
  const Seen* seen_at(int64_t trigger) const;
  enum class Match : uint8_t { no, wait, yes };
  Match matches(int64_t start, Anchor& anchor) const;
  std::optional<Anchor> without_full_frame(int64_t start) const;
  Match matches_by_tracking(int64_t start, Anchor& anchor) const;
  bool may_be_tracking(const Seen& full, const Anchor& anchor) const;
  Match follows(const Anchor& anchor, uint32_t required) const;

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
  std::optional<int64_t> lost_anchor_;   // of this epoch, if the program has not ended
  std::optional<int64_t> found_marker_;  // counter's trigger of the last anchor
  bool begun_ = false;                   // without a marker, the first frame is the start
  uint64_t epoch_ = 0;
  bool ended_ = false;  // the last label was after the end
  bool over_ = false;   // the program has ended, and no marker came since
  std::deque<Seen> seen_;
  std::optional<int64_t> last_;      // counter's trigger of the last labeled frame
  uint64_t dropped_since_last_ = 0;  // unlabeled frames that used up a trigger
  ImageEvidence before_;             // of the previous frame
  Pending pending_;
  std::optional<int64_t> last_off_;         // counter's trigger near the last frame of no trigger
  std::optional<int64_t> confirmed_until_;  // counter's trigger; no new marker is before it
  uint32_t contradiction_score_ = 0;
  std::optional<int64_t> waiting_since_, now_;  // ns
  bool overdue_reported_ = false;
};

}  // namespace inverse
