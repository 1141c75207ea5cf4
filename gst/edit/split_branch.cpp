// SPDX-License-Identifier: LGPL-2.1-or-later
#include "split_branch.hpp"

#include <string>

#include "gst/base/meta/view_meta.hpp"
#include "gst/base/pads/caps.hpp"
#include "gst/base/pads/missing_layers.hpp"
#include "gst/base/pads/pads.hpp"

namespace inverse {
namespace {

/// Scalar layers first offer gray.
GstCaps* format_caps(SplitLayer layer) {
  const bool scalar =
      layer == SplitLayer::mask || layer == SplitLayer::direct || layer == SplitLayer::mirror;
  return pixel_caps(scalar ? Prefer::gray : Prefer::color);
}

/// Says in the caps which transfer curve the samples have, unless what follows insists on its own.
void describe_encoding(GstCaps* caps, SplitParams::Encoding encoding) {
  GstStructure* structure = gst_caps_get_structure(caps, 0);
  if (gst_structure_has_field(structure, "colorimetry")) return;
  GstVideoInfo info;
  if (!gst_video_info_from_caps(&info, caps)) return;
  GstVideoColorimetry& color = info.colorimetry;
  color.transfer = encoding == SplitParams::Encoding::linear ? GST_VIDEO_TRANSFER_GAMMA10
                                                             : GST_VIDEO_TRANSFER_SRGB;
  if (color.primaries == GST_VIDEO_COLOR_PRIMARIES_UNKNOWN)
    color.primaries = GST_VIDEO_COLOR_PRIMARIES_BT709;
  gchar* text = gst_video_colorimetry_to_string(&color);
  gst_structure_set(structure, "colorimetry", G_TYPE_STRING, text, nullptr);
  g_free(text);
}

struct MetaCopy {
  GstBuffer* target;
};

/// Copies metas about the picture; those about memory (the layers, too) do not hold for the copy.
gboolean copy_meta(GstBuffer* source, GstMeta** meta, gpointer data) {
  const GstMetaInfo* info = (*meta)->info;
  if (!info->transform_func ||
      gst_meta_api_type_has_tag(info->api, g_quark_from_static_string(GST_META_TAG_MEMORY_STR)))
    return TRUE;
  GstMetaTransformCopy copy{FALSE, 0, static_cast<gsize>(-1)};
  info->transform_func(static_cast<MetaCopy*>(data)->target, *meta, source,
                       _gst_meta_transform_copy, &copy);
  return TRUE;
}

}  // namespace

SplitBranch::SplitBranch(GstPad* pad, SplitLayer layer, uint32_t base)
    : pad_(GST_PAD(gst_object_ref(pad))), layer_(layer), base_(base) {
  gst_video_info_init(&info_);
}

SplitBranch::~SplitBranch() {
  drop_pool();
  gst_object_unref(pad_);
}

const char* SplitBranch::template_of(SplitLayer layer) {
  constexpr const char* kNames[] = {"reflectance", "shading",     "mask",    "input",    "direct",
                                    "indirect",    "indirect_%u", "diffuse", "specular", "mirror"};
  return kNames[static_cast<size_t>(layer)];
}

std::string SplitBranch::name() const {
  gchar* name = gst_pad_get_name(pad_);
  std::string result = name;
  g_free(name);
  return result;
}

GstCaps* SplitBranch::caps_for(SplitLayer layer, const GstCaps* layers) {
  GstCaps* formats = format_caps(layer);
  if (gst_caps_is_any(layers)) return formats;
  GstCaps* shapes = gst_caps_new_empty();
  for (guint i = 0; i < gst_caps_get_size(layers); ++i) {
    GstStructure* shape = gst_structure_copy(gst_caps_get_structure(layers, i));
    for (const char* field : {"format", "colorimetry", "chroma-site", "layers"})
      gst_structure_remove_field(shape, field);
    gst_caps_append_structure(shapes, shape);
  }
  GstCaps* caps = gst_caps_intersect_full(formats, shapes, GST_CAPS_INTERSECT_FIRST);
  gst_caps_unref(shapes);
  gst_caps_unref(formats);
  return caps;
}

void SplitBranch::negotiate(const GstCaps* layers, const SplitParams& params) {
  forget();
  gst_pad_check_reconfigure(pad_);  // this is what it asks for
  const bool of_material = layer_ >= SplitLayer::diffuse;
  const bool of_all = layer_ == SplitLayer::mask || layer_ == SplitLayer::input;
  if (!of_all && carries_kind(layers, kMaterialLayers) != of_material)
    throw Error(ErrorKind::unsupported,
                "these layers are " + contents_of(kind_of(layers)) + " and have no " + name() +
                    ", as the pad of intrinsicsplit of this name is to send it; put " +
                    (of_material                    ? "limematerial"
                     : layer_ >= SplitLayer::direct ? "globalintrinsic"
                                                    : "intrinsicdecomp") +
                    " in the place of the decomposer before it");
  if (layer_ >= SplitLayer::direct && !of_material && !carries_kind(layers, kGlobalLayers))
    throw Error(ErrorKind::unsupported,
                "these layers do not separate direct light from indirect, as pad " + name() +
                    " of intrinsicsplit is to send it; put globalintrinsic in the place of the "
                    "decomposer before it");
  GstCaps* ours = caps_for(layer_, layers);
  GstCaps* caps = gst_pad_peer_query_caps(pad_, ours);
  gst_caps_unref(ours);
  if (gst_caps_is_empty(caps)) {
    gst_caps_unref(caps);
    throw Error(ErrorKind::unsupported,
                std::string("what follows pad ") + name() +
                    " of intrinsicsplit takes none of its formats at this size; insert "
                    "videoconvert, and videoscale where the size differs");
  }
  caps = gst_caps_fixate(gst_caps_truncate(caps));
  describe_encoding(caps, params.encoding);
  drop_hdr_metadata(caps);
  try {
    if (!gst_video_info_from_caps(&info_, caps))
      throw Error(ErrorKind::unsupported, std::string("pad ") + name() +
                                              " of intrinsicsplit was asked for an impossible "
                                              "video format");
    GstVideoInfo of_layers;
    const bool known = gst_video_info_from_caps(&of_layers, layers);
    primaries_ = known ? of_layers.colorimetry.primaries : GST_VIDEO_COLOR_PRIMARIES_UNKNOWN;
    output_.emplace(info_, primaries_, params.encoding == SplitParams::Encoding::linear);
    GstCaps* current = gst_pad_get_current_caps(pad_);
    if (!current || !gst_caps_is_equal(current, caps))
      gst_pad_push_event(pad_, gst_event_new_caps(caps));
    if (current) gst_caps_unref(current);
    choose_pool(caps);
  } catch (...) {
    gst_caps_unref(caps);
    throw;
  }
  gst_caps_unref(caps);
}

void SplitBranch::choose_pool(GstCaps* caps) {
  GstQuery* query = gst_query_new_allocation(caps, TRUE);
  // Where nobody answers, the query stays as it is, and a pool of our own does.
  gst_pad_peer_query(pad_, query);
  GstBufferPool* pool = nullptr;
  guint size = 0, min_buffers = 0, max_buffers = 0;
  if (gst_query_get_n_allocation_pools(query) > 0)
    gst_query_parse_nth_allocation_pool(query, 0, &pool, &size, &min_buffers, &max_buffers);
  const bool strides = gst_query_find_allocation_meta(query, GST_VIDEO_META_API_TYPE, nullptr);
  gst_query_unref(query);
  const guint needed = MAX(size, static_cast<guint>(GST_VIDEO_INFO_SIZE(&info_)));
  for (const bool own : {false, true}) {
    if (own) pool = gst_video_buffer_pool_new();
    if (!pool) continue;
    GstStructure* config = gst_buffer_pool_get_config(pool);
    gst_buffer_pool_config_set_params(config, caps, needed, own ? 0 : min_buffers,
                                      own ? 0 : max_buffers);
    if (strides) gst_buffer_pool_config_add_option(config, GST_BUFFER_POOL_OPTION_VIDEO_META);
    if (gst_buffer_pool_set_config(pool, config) && gst_buffer_pool_set_active(pool, TRUE)) {
      pool_ = pool;
      return;
    }
    gst_object_unref(pool);
    pool = nullptr;
  }
  throw Error(ErrorKind::out_of_memory,
              std::string("no buffers for pad ") + name() + " of intrinsicsplit");
}

void SplitBranch::drop_pool() {
  if (!pool_) return;
  gst_buffer_pool_set_active(pool_, FALSE);
  gst_object_unref(pool_);
  pool_ = nullptr;
}

void SplitBranch::forget() {
  drop_pool();
  readback_.reset();
  output_.reset();
  announced_.reset();
}

void SplitBranch::record(gpu::Commands& commands, const Layers& layers, LayerPictures& pictures,
                         const SplitParams& params) {
  if (!readback_ || readback_->device() != commands.device()) {
    output_->configure(commands.device());
    readback_ = output_->make_buffer(commands.device());
  }
  const Picture picture = pictures.draw(commands, layers, layer_, params, "intrinsicsplit", base_);
  output_->record(commands, picture, layers, readback_, nullptr);
  commands.count_download(readback_->bytes());
}

void SplitBranch::announce(const SplitParams& params, bool edited) {
  if (layer_ == SplitLayer::input || layer_ == SplitLayer::bounced || layer_ >= SplitLayer::diffuse)
    return;
  SentPicture sent{layer_, info_, primaries_, params, edited};
  if (announced_ && *announced_ == sent) return;
  gst_pad_push_event(pad_, sent.event());
  announced_ = sent;
}

GstFlowReturn SplitBranch::take(GstBuffer* source, GstBuffer** buffer) {
  GstBuffer* made = nullptr;
  const GstFlowReturn result = gst_buffer_pool_acquire_buffer(pool_, &made, nullptr);
  if (result != GST_FLOW_OK) return result;
  try {
    output_->write(readback_, made);
  } catch (...) {
    gst_buffer_unref(made);
    throw;
  }
  gst_buffer_copy_into(
      made, source,
      static_cast<GstBufferCopyFlags>(GST_BUFFER_COPY_FLAGS | GST_BUFFER_COPY_TIMESTAMPS), 0,
      static_cast<gsize>(-1));
  MetaCopy copy{made};
  gst_buffer_foreach_meta(source, copy_meta, &copy);
  if (layer_ != SplitLayer::input)
    mark_view(made, {label_of(element_of_pad(pad_).get()), name(), "use pad input"});
  *buffer = made;
  return GST_FLOW_OK;
}

}  // namespace inverse
