// SPDX-License-Identifier: MIT
#include <algorithm>
#include <set>

#include "scene/gltf_nodes.hpp"

namespace sheaf {
namespace {

using nlohmann::json;

struct ChannelReader {
  GltfFile& file;
  const Accessors& accessors;
  const std::vector<MeshEntry>& meshes;
  std::string place;

  // False where the channel is to be passed over.
  bool target(const json& object, Channel& channel) {
    const json& target = object.at("target");
    const std::string path = target.at("path").get<std::string>();
    if (path == "pointer") {
      file.warn(place, "animates a pointer (KHR_animation_pointer), which is ignored");
      return false;
    }
    if (!target.contains("node")) return false;
    channel.node = target.at("node").get<std::uint32_t>();
    if (path == "translation") {
      channel.path = ChannelPath::translation;
    } else if (path == "rotation") {
      channel.path = ChannelPath::rotation;
      channel.width = 4;
    } else if (path == "scale") {
      channel.path = ChannelPath::scale;
    } else if (path == "weights") {
      return weights(channel);
    } else {
      file.fail(place + ".target.path", in_quotes(path) + " is not translation, rotation, scale or weights");
    }
    return true;
  }

  bool weights(Channel& channel) {
    channel.path = ChannelPath::weights;
    const int mesh = file.model.nodes[channel.node].mesh;
    if (mesh < 0 || file.model.meshes[static_cast<std::size_t>(mesh)].primitives.empty()) {
      file.warn(place, "animates the weights of a node that has no mesh, and is ignored");
      return false;
    }
    channel.width =
        static_cast<std::uint32_t>(file.model.meshes[static_cast<std::size_t>(mesh)].primitives[0].targets.size());
    if (channel.width == 0) {
      file.warn(place, "animates the weights of a mesh that has no morph targets, and is ignored");
      return false;
    }
    return true;
  }

  void keys(const json& sampler, Channel& channel) {
    const std::string mode = sampler.value("interpolation", "LINEAR");
    if (mode == "STEP") {
      channel.interpolation = Interpolation::step;
    } else if (mode == "CUBICSPLINE") {
      channel.interpolation = Interpolation::cubic_spline;
    } else if (mode != "LINEAR") {
      file.fail(place, "interpolation " + in_quotes(mode) + " is not STEP, LINEAR or CUBICSPLINE");
    }
    const auto times = accessors.floats(sampler.at("input").get<int>(), 1, Components::floats, "animation input");
    channel.times.assign(times.begin(), times.end());
    if (channel.times.front() < 0) file.fail(place, "has a negative key time");
    for (std::size_t k = 1; k < channel.times.size(); ++k) {
      if (!(channel.times[k] > channel.times[k - 1]))
        file.fail(place, "key times are not strictly increasing at key " + std::to_string(k));
    }
    values(sampler.at("output").get<int>(), channel);
  }

  void values(int accessor, Channel& channel) {
    const bool vectors = channel.path == ChannelPath::translation || channel.path == ChannelPath::scale;
    const int width = channel.path == ChannelPath::weights ? 1 : static_cast<int>(channel.width);
    const auto values = accessors.floats(accessor, width, vectors ? Components::floats : Components::floats_normalized,
                                         "animation output");
    const std::size_t parts = channel.interpolation == Interpolation::cubic_spline ? 3 : 1;
    const std::size_t expected = channel.times.size() * parts * channel.width;
    if (values.size() != expected) {
      file.fail(place, "output holds " + std::to_string(values.size()) + " numbers, its keys need " +
                           std::to_string(expected));
    }
    channel.values.assign(values.begin(), values.end());
  }
};

Animation read_animation(GltfFile& file, const Accessors& accessors, const std::vector<MeshEntry>& meshes,
                         std::size_t index, Scene& scene) {
  const json& object = file.json["animations"][index];
  Animation animation;
  animation.name = object.value("name", "");
  std::set<std::pair<std::uint32_t, ChannelPath>> targets;
  const json& channels = object.at("channels");
  for (std::size_t c = 0; c < channels.size(); ++c) {
    ChannelReader reader{file, accessors, meshes, at("animations", index) + "." + at("channels", c)};
    Channel channel;
    if (!reader.target(channels[c], channel)) continue;
    reader.keys(object.at("samplers").at(channels[c].at("sampler").get<std::size_t>()), channel);
    if (!targets.emplace(channel.node, channel.path).second) {
      file.warn(reader.place, "animates what an earlier channel of the animation already does: the later one holds");
    }
    if (scene.nodes[channel.node].has_matrix && channel.path != ChannelPath::weights) {
      file.warn(reader.place, "animates " + at("nodes", channel.node) +
                                  ", which has a matrix: the parts that it is made of are used");
    }
    animation.duration = std::max(animation.duration, channel.times.back());
    animation.channels.push_back(std::move(channel));
  }
  return animation;
}

}  // namespace

void load_animations(GltfFile& file, const std::vector<MeshEntry>& meshes, Scene& scene) {
  const Accessors accessors(file);
  for (std::size_t i = 0; i < file.count("animations"); ++i) {
    try {
      file.require("animations", i);
      scene.animations.push_back(read_animation(file, accessors, meshes, i, scene));
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::input) throw;
      Animation& animation = scene.animations.emplace_back();
      animation.name = file.json["animations"][i].value("name", "");
      animation.fault = error.what();
      file.warn_of(animation.fault, "the animation cannot be used");
    }
  }
}

}  // namespace sheaf
