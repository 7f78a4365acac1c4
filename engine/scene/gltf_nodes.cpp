// SPDX-License-Identifier: MIT
#include "scene/gltf_nodes.hpp"

#include <algorithm>
#include <cmath>
#include <glm/gtc/type_ptr.hpp>

#include "scene/last_row.hpp"

namespace sheaf {
namespace {

void read_transform(GltfFile& file, const tinygltf::Node& source, const std::string& place, Node& node) {
  if (!source.matrix.empty()) {
    node.has_matrix = true;
    node.matrix = glm::make_mat4(source.matrix.data());
    const Rounding rounding = round_last_row(node.matrix);
    if (rounding == Rounding::impossible) file.fail(place + ".matrix", "has a last row other than 0 0 0 1");
    if (rounding == Rounding::rounded) file.warn(place + ".matrix", "has a last row near 0 0 0 1, taken as that");
    return;
  }
  if (!source.translation.empty()) node.translation = glm::make_vec3(source.translation.data());
  if (!source.scale.empty()) node.scale = glm::make_vec3(source.scale.data());
  if (source.rotation.empty()) return;
  const glm::dquat q(source.rotation[3], source.rotation[0], source.rotation[1], source.rotation[2]);
  const double length = glm::length(q);
  if (length > 0) {
    node.rotation = q / length;
  } else {
    file.warn(place + ".rotation", "has no length, identity is used");
  }
}

// A node has one parent at most, and following parents ends at a root.
void link_parents(const GltfFile& file, Scene& scene) {
  for (std::uint32_t i = 0; i < scene.nodes.size(); ++i) {
    for (const std::uint32_t child : scene.nodes[i].children) {
      Node& node = scene.nodes[child];
      if (node.parent != none) {
        file.fail(at("nodes", i) + ".children",
                  "node " + std::to_string(child) + " already is a child of node " + std::to_string(node.parent));
      }
      node.parent = i;
    }
  }
  std::vector<bool> reached(scene.nodes.size(), false);
  std::vector<std::uint32_t> stack;
  for (std::uint32_t i = 0; i < scene.nodes.size(); ++i) {
    if (scene.nodes[i].parent == none) stack.push_back(i);
  }
  while (!stack.empty()) {
    const std::uint32_t i = stack.back();
    stack.pop_back();
    reached[i] = true;
    stack.insert(stack.end(), scene.nodes[i].children.begin(), scene.nodes[i].children.end());
  }
  const auto lost = std::ranges::find(reached, false);
  if (lost != reached.end()) {
    file.fail(at("nodes", static_cast<std::size_t>(lost - reached.begin())), "is its own ancestor");
  }
}

// The scene's index in the file, or none where the file has no scenes.
std::uint32_t chosen_scene(const GltfFile& file, const std::string& selector) {
  const auto& scenes = file.model.scenes;
  if (selector.empty()) {
    if (file.model.defaultScene >= 0) return static_cast<std::uint32_t>(file.model.defaultScene);
    return scenes.empty() ? none : 0;
  }
  for (std::uint32_t i = 0; i < scenes.size(); ++i) {
    if (scenes[i].name == selector) return i;
  }
  const bool digits =
      selector.size() <= 9 && std::ranges::all_of(selector, [](char c) { return c >= '0' && c <= '9'; });
  if (digits && std::stoul(selector) < scenes.size()) return static_cast<std::uint32_t>(std::stoul(selector));
  file.fail("scenes", "there is no scene " + in_quotes(selector) + " among " + std::to_string(scenes.size()));
}

}  // namespace

void load_nodes(GltfFile& file, Scene& scene) {
  const std::size_t count = file.model.nodes.size();
  if (count > file.limits.nodes) file.over_limit("nodes", "more than " + std::to_string(file.limits.nodes) + " nodes");
  scene.nodes.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const tinygltf::Node& source = file.model.nodes[i];
    Node& node = scene.nodes[i];
    node.name = source.name;
    node.children.assign(source.children.begin(), source.children.end());
    if (source.camera >= 0) node.camera = static_cast<std::uint32_t>(source.camera);
    if (const auto* light = extension(file.json["nodes"][i], "KHR_lights_punctual")) {
      node.light = light->at("light").get<std::uint32_t>();
    }
    if (const auto* visibility = extension(file.json["nodes"][i], "KHR_node_visibility"))
      node.visible = visibility->value("visible", true);
    read_transform(file, source, at("nodes", i), node);
  }
  link_parents(file, scene);
}

void select_scene(GltfFile& file, const std::string& selector, Scene& scene) {
  const std::uint32_t chosen = chosen_scene(file, selector);
  if (chosen == none) {
    for (std::uint32_t i = 0; i < scene.nodes.size(); ++i) {
      if (scene.nodes[i].parent == none) scene.roots.push_back(i);
    }
  } else {
    file.require("scenes", chosen);
    const std::vector<int>& nodes = file.model.scenes[chosen].nodes;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const auto node = static_cast<std::uint32_t>(nodes[i]);
      const std::string place = at("scenes", chosen) + "." + at("nodes", i);
      if (scene.nodes[node].parent != none) {
        file.fail(place, "node " + std::to_string(node) + " is a child of node " +
                             std::to_string(scene.nodes[node].parent) + ", not a root");
      }
      if (std::ranges::count(scene.roots, node) > 0)
        file.fail(place, "node " + std::to_string(node) + " is listed twice");
      scene.roots.push_back(node);
    }
  }
  scene.order = scene.roots;
  for (std::size_t i = 0; i < scene.order.size(); ++i) {
    const std::vector<std::uint32_t>& children = scene.nodes[scene.order[i]].children;
    scene.order.insert(scene.order.end(), children.begin(), children.end());
  }
}

void hide_nodes(Scene& scene) {
  for (const std::uint32_t i : scene.order) {  // parents before children
    Node& node = scene.nodes[i];
    node.shown = node.visible && (node.parent == none || scene.nodes[node.parent].shown);
    if (!node.shown) node.light = none;
  }
}

void report_levels_of_detail(const GltfFile& file, const Scene& scene) {
  for (const std::uint32_t i : scene.order) {
    if (const auto* levels = extension(file.json["nodes"][i], "MSFT_lod"))
      file.warn(at("nodes", i) + ".MSFT_lod",
                "the finest of " + std::to_string(levels->at("ids").size() + 1) + " levels of detail is drawn");
  }
}

}  // namespace sheaf
