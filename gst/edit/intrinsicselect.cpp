// SPDX-License-Identifier: LGPL-2.1-or-later
// intrinsicselect: writes the mask layer, by which later editors are limited to an object.
#include <algorithm>
#include <deque>
#include <iterator>
#include <optional>
#include <string>
#include <utility>

#include "gst/base/color.hpp"
#include "gst/base/filter.hpp"
#include "gst/base/pictures/file_loader.hpp"
#include "kernels/edit/selection/selection.hpp"
#include "selection_strokes.hpp"

namespace inverse {
namespace {

struct Params : SelectionParams {
  std::string strokes;  ///< read_selection
  SelectMode mode = SelectMode::off;
  float radius = 6;
  std::string location;
  uint32_t key_color = 0xffc83c28;
  Params() { color.base = color.cluster = 0; }
};

/// Reaches into SelectionParams::color.
template <typename T>
auto of_color(T RecolorParams::*field) {
  return [field](Params& params) -> T& { return params.color.*field; };
}

const PropertyTable<Params>& table() {
  using P = Params;
  static const PropertyTable<P> table = [] {
    Property<P> strokes = text<P>(
        "strokes::list", &P::strokes,
        "JSON list of strokes on objects: [{\"kind\":\"add\",\"points\":[[x,y],...]}], in pixels; "
        "kind is add or subtract, \"closed\":true takes what is inside of the line, and nothing "
        "that borders on it");
    strokes.wrong = wrong_selection;
    return PropertyTable<P>{
        choice<P>("by", &P::by, "GstInverseSelectBy",
                  {{static_cast<int>(SelectBy::strokes), "strokes",
                    "The object under the user's strokes, followed over time"},
                   {static_cast<int>(SelectBy::key), "key", "A reflectance"},
                   {static_cast<int>(SelectBy::cluster), "cluster", "A cluster of reflectance"},
                   {static_cast<int>(SelectBy::base_color), "base-color",
                    "The surfaces of a base color of globalintrinsic"},
                   {static_cast<int>(SelectBy::picture), "picture", "What is white in a picture"}},
                  "What is selected"),
        strokes,
        choice<P>("strokes::mode", &P::mode, "GstInverseSelectMode",
                  {{static_cast<int>(SelectMode::off), "off", "Navigation events do nothing"},
                   {static_cast<int>(SelectMode::add), "add",
                    "Clicks and drags select what is under them"},
                   {static_cast<int>(SelectMode::subtract), "subtract",
                    "Clicks and drags take away what is under them"},
                   {static_cast<int>(SelectMode::lasso), "lasso",
                    "Drags select what is inside of the line, and nothing that borders on it"}},
                  "What the mouse draws on the picture"),
        number<P>("strokes::radius", &P::radius, 1.F, 1000.F,
                  "Radius of the brush for strokes, pixels"),
        text<P>("location", &P::location,
                "PNG or JPEG file of the mask, scaled to the frame: white, times its alpha, is "
                "selected; by=picture"),
        color<P>("key", &P::key_color,
                 "Reflectance to select (0xAARRGGBB, sRGB; alpha is ignored); by=key"),
        number<P>("tolerance", of_color(&RecolorParams::tolerance), 0, 4.25F,
                  "Maximum distance of chromaticity R / mean(R) from the key's; gray is 2.45 from "
                  "a pure primary"),
        number<P>("value-tolerance", of_color(&RecolorParams::value_tolerance), 0,
                  RecolorParams::kAnyValue,
                  "Maximum distance of mean reflectance from the key's, |ln ratio|: 0.7 is a "
                  "factor of two; 20 = any"),
        number<P>("softness", of_color(&RecolorParams::softness), 0, 3,
                  "Distance beyond the tolerances over which the selection falls to 0, in their "
                  "units; 0 = hard edges"),
        number<P>("base-color", of_color(&RecolorParams::base), 0, static_cast<int>(kMaxBases) - 1,
                  "Base color to select, as numbered by show=layer; by=base-color"),
        number<P>("cluster", of_color(&RecolorParams::cluster), 0,
                  static_cast<int>(Palette::kMaxClusters) - 1,
                  "Cluster to select, as listed in stats; by=cluster"),
        number<P>("clusters", of_color(&RecolorParams::clusters), 1,
                  static_cast<int>(Palette::kMaxClusters), "Number of clusters to search for"),
        choice<P>("combine", &P::combine, "GstInverseSelectCombine",
                  {{static_cast<int>(Combine::replace), "replace", "Discards the mask before"},
                   {static_cast<int>(Combine::add), "add", "Selects what either selects"},
                   {static_cast<int>(Combine::subtract), "subtract",
                    "Takes the selection from the mask before"},
                   {static_cast<int>(Combine::intersect), "intersect", "Selects what both select"}},
                  "What happens to the mask of an intrinsicselect before"),
        flag<P>("invert", &P::invert, "Select everything else"),
        flag<P>("soft-edges", &P::soft,
                "Let edges follow the frame's, by the mixture of light there; false = hard edges"),
    };
  }();
  return table;
}

/// The mean of a picture's channels times its alpha, scaled to `extent`: averaged over the smallest
/// whole factor by which it is not larger, then bilinear. In x of four numbers a pixel.
std::vector<float> mask_of(const Picture8& picture, Extent extent) {
  const uint32_t factor =
      std::max({1U, picture.extent.width / extent.width, picture.extent.height / extent.height});
  const Extent small{(picture.extent.width + factor - 1) / factor,
                     (picture.extent.height + factor - 1) / factor};
  std::vector<float> means(small.pixels()), counts(small.pixels());
  for (uint32_t y = 0; y < picture.extent.height; ++y)
    for (uint32_t x = 0; x < picture.extent.width; ++x) {
      const uint8_t* rgba = &picture.rgba[4 * (size_t{y} * picture.extent.width + x)];
      const size_t to = size_t{y / factor} * small.width + x / factor;
      means[to] += static_cast<float>((rgba[0] + rgba[1] + rgba[2]) * rgba[3]) / (3 * 255.F * 255);
      ++counts[to];
    }
  const auto at = [&](uint32_t x, uint32_t y) {
    const size_t n =
        size_t{std::min(y, small.height - 1)} * small.width + std::min(x, small.width - 1);
    return means[n] / counts[n];
  };
  std::vector<float> mask(4 * extent.pixels());
  const auto source = [](uint32_t to, uint32_t from_size, uint32_t to_size) {
    const float place = (static_cast<float>(to) + .5F) * static_cast<float>(from_size) /
                            static_cast<float>(to_size) -
                        .5F;
    return std::max(place, 0.F);
  };
  for (uint32_t y = 0; y < extent.height; ++y)
    for (uint32_t x = 0; x < extent.width; ++x) {
      const float u = source(x, small.width, extent.width),
                  v = source(y, small.height, extent.height);
      const auto left = static_cast<uint32_t>(u), top = static_cast<uint32_t>(v);
      const float across = u - static_cast<float>(left), down = v - static_cast<float>(top);
      mask[4 * (size_t{y} * extent.width + x)] =
          (1 - down) * ((1 - across) * at(left, top) + across * at(left + 1, top)) +
          down * ((1 - across) * at(left, top + 1) + across * at(left + 1, top + 1));
    }
  return mask;
}

class SelectElement final : public Filter {
 public:
  PropertyStore& parameters() override { return parameters_; }
  void start() override { file_.start(parameters_.snapshot().location); }
  void configure(const std::shared_ptr<gpu::Device>& device, Extent extent) override {
    selection_.emplace(device, extent);
    for (auto& copy : copies_)
      copy.words = gpu::Buffer::create(device, gpu::Element::word, ObjectSelection::kStatusWords,
                                       gpu::Memory::readback);
    taken_ = {};
    left_.clear();
    mask_.reset();
    editor_.resize(extent);
  }
  std::vector<Setting> navigate(const MouseEvent& event) override {
    const Params params = parameters_.snapshot();
    editor_.mouse(log(), event, params.mode, params.radius);
    return {};
  }
  void flushed() override { editor_.flush(); }
  SelectionEditor& editor() { return editor_; }
  void release() override {
    selection_.reset();
    left_.clear();
    mask_.reset();
    copies_ = {};
  }

  void process(FrameContext& frame) override {
    Params params = parameters_.snapshot();
    const Span now = span_of(frame);
    if (frame.fresh) break_off(frame, now);
    shown_ = now;
    params.color.key = linear_color(params.key_color);
    if (params.by == SelectBy::base_color && !frame.layers[Role::bases] && !frame.layers.global() &&
        !std::exchange(reported_, true))
      frame.warnings.push_back(
          "by=base-color selects nothing, as this video comes without base "
          "colors; put globalintrinsic in the place of the decomposer, or "
          "select by strokes or key");
    for (std::string& warning : editor_.take_warnings())
      frame.warnings.push_back(std::move(warning));
    Selection::Strokes added{{}, frame.layers.extent};
    const bool other = params.by == SelectBy::strokes && params.strokes != taken_.text;
    if (other && !come_back(frame.commands, params.strokes, now)) {
      Taken next{params.strokes, read_selection(params.strokes), now};
      // Strokes that were drawn before were on another frame: what they selected has moved since.
      added.restart = !next.list.begins_with(taken_.list);
      if (!added.restart && !taken_.text.empty() && !taken_.drawn.meets(now)) next.drawn = {};
      const size_t known = added.restart ? 0 : taken_.list.strokes.size();
      taken_ = std::move(next);
      added.strokes = std::span(taken_.list.strokes).subspan(known);
      if (taken_.list.frame.pixels() > 0) added.drawn = taken_.list.frame;
    }
    selection_->record(frame.commands, frame.layers, params, added, take_picture(frame, params));
    if (!added.strokes.empty() && std::exchange(checked_, taken_.text) != taken_.text)
      std::ranges::move(warnings_of(taken_.list, selection_->object()->stroke_cells(), added.drawn),
                        std::back_inserter(frame.warnings));
    Copy& copy = copies_[frame.number];
    const ObjectSelection* object = selection_->object();
    copy.filled = params.by == SelectBy::strokes && object && object->active();
    if (copy.filled) frame.commands.copy(object->status(), copy.words, copy.words->bytes());
    frame.commands.stage("select");
  }

  void describe(GstStructure* stats, uint64_t number) const override {
    const Copy& copy = copies_[number];
    if (!copy.filled || !selection_ || !selection_->object()) return;
    const auto place = selection_->object()->place_of(copy.words->map_as<uint32_t>());
    gst_structure_set(stats, "object-share", G_TYPE_DOUBLE, place.share, "object-x", G_TYPE_DOUBLE,
                      place.x, "object-y", G_TYPE_DOUBLE, place.y, "object-left", G_TYPE_DOUBLE,
                      place.left, "object-top", G_TYPE_DOUBLE, place.top, "object-right",
                      G_TYPE_DOUBLE, place.right, "object-bottom", G_TYPE_DOUBLE, place.bottom,
                      nullptr);
  }

 private:
  /// The stream time that a frame is shown.
  struct Span {
    GstClockTime begin = GST_CLOCK_TIME_NONE, end = GST_CLOCK_TIME_NONE;
    /// Whether two are of the same frame. A seek into a frame cuts its beginning off, and times of
    /// some files are rounded, so that the end of a frame is behind the beginning of the next one.
    bool meets(const Span& other) const {
      if (begin == GST_CLOCK_TIME_NONE || other.begin == GST_CLOCK_TIME_NONE) return false;
      const GstClockTime from = std::max(begin, other.begin), to = std::min(end, other.end);
      return begin == other.begin ||
             (to > from && 2 * (to - from) > std::min(end - begin, other.end - other.begin));
    }
  };
  /// Strokes that the selection has, and when all of them were drawn; never: at several times.
  struct Taken {
    std::string text;
    SelectionList list;
    Span drawn;
  };
  /// Strokes that were left for others, e.g. by undo, the selection by them, and when that was.
  struct Left {
    Taken taken;
    ObjectSelection::State state;
    Span shown;
  };

  static Span span_of(const FrameContext& frame) {
    const GstClockTime length = GST_BUFFER_DURATION(frame.in);
    return {frame.time, frame.time + (GST_CLOCK_TIME_IS_VALID(length) ? length : 0)};
  }

  /// The frame does not follow the one before.
  void break_off(const FrameContext& frame, const Span& now) {
    if (frame.new_stream || !GST_CLOCK_TIME_IS_VALID(now.begin)) {
      selection_->reset();
      taken_ = {};
      left_.clear();
    } else if (!now.meets(shown_)) {
      selection_->lose(frame.commands);
      if (taken_.drawn.meets(now)) taken_ = {};  // the strokes are on this frame
    }
  }

  /// Goes back to the selection by strokes that there were before. Whether that is known.
  bool come_back(gpu::Commands& commands, const std::string& strokes, const Span& now) {
    constexpr size_t kMaxLeft = 8;
    if (!taken_.text.empty()) left_.push_front({taken_, selection_->save(commands), shown_});
    if (left_.size() > kMaxLeft) left_.pop_back();
    const auto found = std::ranges::find(
        left_, strokes, [](const Left& left) -> const auto& { return left.taken.text; });
    if (found == left_.end()) return false;
    taken_ = std::move(found->taken);
    selection_->restore(commands, found->state);
    if (!found->shown.meets(now)) selection_->lose(commands);
    left_.erase(found);
    return true;
  }

  /// The picture of the mask for frames of this size; null: none.
  const Plane* take_picture(FrameContext& frame, const Params& params) {
    if (file_.take(params.location, frame.warnings)) mask_.reset();
    if (params.by != SelectBy::picture || !file_.file()) return nullptr;
    if (!mask_) {
      mask_.emplace(Plane{frame.layers.extent, nullptr});
      frame.commands.write_table(mask_->buffer, gpu::Element::vec4,
                                 mask_of(*file_.file(), frame.layers.extent));
    }
    return &*mask_;
  }

  Parameters<Params> parameters_{table()};
  FileLoader file_;
  std::optional<Plane> mask_;  // of the file
  std::optional<Selection> selection_;
  SelectionEditor editor_;
  Taken taken_;
  Span shown_;             // of the frame before
  std::deque<Left> left_;  // the last one first
  std::string checked_;    // strokes that were checked last
  bool reported_ = false;  // that there are no base colors
  struct Copy {
    gpu::BufferPtr words;
    bool filled = false;
  };
  gpu::FrameRing<Copy> copies_;  // where the object is
};

SelectionEditor& editor_of(Filter& filter) { return static_cast<SelectElement&>(filter).editor(); }

std::vector<Action> actions() {
  return {edit_action<editor_of, &SelectionEditor::add>("add-stroke"),
          edit_action<editor_of, &SelectionEditor::remove>("remove-stroke"),
          edit_action<editor_of, &SelectionEditor::clear>("clear-strokes"),
          edit_action<editor_of, &SelectionEditor::undo>("undo-stroke")};
}

}  // namespace

extern const ElementInfo kIntrinsicSelect;
const ElementInfo kIntrinsicSelect{
    .factory = "intrinsicselect",
    .type_name = "GstIntrinsicSelect",
    .long_name = "Intrinsic select",
    .klass = "Filter/Video",
    .description = "Selects an object, for the editors after it",
    .sink = Flow::layers_or_pixels,
    .src = Flow::layers,
    .layers = kAnyLayers,
    .needs = "intrinsicdecomp",
    .create = [] { return std::unique_ptr<Filter>(new SelectElement); },
    .actions = actions(),
    .navigation = true,
};

}  // namespace inverse
