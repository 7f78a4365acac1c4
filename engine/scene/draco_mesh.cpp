// SPDX-License-Identifier: MIT
#include "scene/draco_mesh.hpp"

#include <draco/compression/mesh/mesh_edgebreaker_decoder.h>
#include <draco/compression/mesh/mesh_sequential_decoder.h>
#include <draco/core/varint_decoding.h>
#include <draco/mesh/mesh.h>
#include <draco/metadata/metadata_decoder.h>

#include <cstring>
#include <memory>
#include <type_traits>

namespace sheaf {
namespace {

struct Fault {
  std::string reason;
  bool over_limit = false;
};

// Entropy coding can store what is wholly regular in next to nothing. Meshes of real shapes stay far below this.
constexpr std::uint64_t most_per_byte = 4096;

struct Counts {
  std::uint8_t method = 0;
  std::uint32_t triangles = 0, vertices = 0;
};

// What the head of the data says, of which the decoder would take memory without looking.
Counts read_counts(std::span<const std::uint8_t> data) {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(data.data()), data.size());
  draco::DracoHeader header;
  if (!draco::PointCloudDecoder::DecodeHeader(&buffer, &header).ok()) throw Fault{"is not Draco data"};
  if (header.encoder_type != draco::TRIANGULAR_MESH) throw Fault{"holds points, not a mesh"};
  if (header.version_major != 2 || header.version_minor != 2)
    throw Fault{"is of Draco's bitstream version " + std::to_string(header.version_major) + "." +
                std::to_string(header.version_minor) + ", only 2.2 is supported"};
  buffer.set_bitstream_version(DRACO_BITSTREAM_VERSION(2, 2));
  if ((header.flags & METADATA_FLAG_MASK) != 0) {
    draco::GeometryMetadata metadata;
    if (!draco::MetadataDecoder().DecodeGeometryMetadata(&buffer, &metadata)) throw Fault{"its metadata is damaged"};
  }
  Counts counts;
  counts.method = header.encoder_method;
  std::uint8_t traversal = 0;
  bool whole = false;
  if (header.encoder_method == draco::MESH_SEQUENTIAL_ENCODING)
    whole = draco::DecodeVarint(&counts.triangles, &buffer) && draco::DecodeVarint(&counts.vertices, &buffer);
  else if (header.encoder_method == draco::MESH_EDGEBREAKER_ENCODING)
    whole = buffer.Decode(&traversal) && draco::DecodeVarint(&counts.vertices, &buffer) &&
            draco::DecodeVarint(&counts.triangles, &buffer);
  else
    throw Fault{"is encoded by an unknown method"};
  if (!whole) throw Fault{"is damaged"};
  return counts;
}

void check_counts(const Counts& counts, std::uint64_t size, const DracoLimits& limits) {
  const auto check = [&](std::uint64_t count, std::uint64_t most, const char* what) {
    if (count > most)
      throw Fault{"has " + std::to_string(count) + " " + what + ", a scene may have " + std::to_string(most), true};
    if (count / most_per_byte > size)
      throw Fault{"has " + std::to_string(count) + " " + what + " in " + std::to_string(size) + " bytes"};
  };
  check(counts.triangles, limits.triangles, "triangles");
  check(counts.vertices, limits.vertices, "vertices");
}

// Once the attributes are described, and before there is memory for their values.
template <class Decoder>
class Bounded : public Decoder {
 public:
  explicit Bounded(const DracoLimits& limits) : limits_(limits) {}

 private:
  bool DecodeAllAttributes() override {
    const draco::PointCloud& cloud = *this->point_cloud();
    std::uint64_t bytes = 0;
    for (int i = 0; i < cloud.num_attributes(); ++i)
      bytes += static_cast<std::uint64_t>(cloud.attribute(i)->byte_stride()) * cloud.num_points();
    if (cloud.num_points() > limits_.vertices)
      throw Fault{"has more than " + std::to_string(limits_.vertices) + " vertices", true};
    if (bytes > limits_.bytes) throw Fault{"holds more than " + std::to_string(limits_.bytes) + " bytes", true};
    return Decoder::DecodeAllAttributes();
  }

  DracoLimits limits_;
};

template <class T>
std::vector<std::uint8_t> values_of(const draco::PointAttribute& attribute, std::uint32_t vertices) {
  const std::size_t width = attribute.num_components();
  std::vector<std::uint8_t> out(vertices * width * sizeof(T));
  std::vector<T> value(width);
  for (std::uint32_t v = 0; v < vertices; ++v) {
    const draco::AttributeValueIndex index = attribute.mapped_index(draco::PointIndex(v));
    if (index.value() >= attribute.size() ||
        !attribute.ConvertValue<T>(index, static_cast<std::int8_t>(width), value.data()))
      throw Fault{"attribute " + std::to_string(attribute.unique_id()) + " holds a value that its accessor cannot"};
    std::memcpy(&out[v * width * sizeof(T)], value.data(), width * sizeof(T));
  }
  return out;
}

std::vector<std::uint8_t> values_of(const draco::Mesh& mesh, const DracoAttribute& wanted) {
  const draco::PointAttribute* const attribute = mesh.GetAttributeByUniqueId(wanted.id);
  const std::string name = "attribute " + std::to_string(wanted.id);
  if (attribute == nullptr) throw Fault{"has no " + name};
  if (attribute->num_components() != wanted.width)
    throw Fault{name + " has " + std::to_string(attribute->num_components()) + " components, its accessor " +
                std::to_string(wanted.width)};
  const draco::DataType type = attribute->data_type();
  const bool of_gltf = (type >= draco::DT_INT8 && type <= draco::DT_UINT32) || type == draco::DT_FLOAT32;
  if (!of_gltf) throw Fault{name + " is of a type that glTF does not have"};
  const auto stored = static_cast<std::uint64_t>(attribute->byte_stride()) * attribute->size();
  const auto element = static_cast<std::uint64_t>(draco::DataTypeLength(type)) * attribute->num_components();
  if (attribute->byte_stride() < static_cast<std::int64_t>(element) || attribute->buffer()->data_size() < stored)
    throw Fault{name + " is damaged"};
  switch (wanted.component_type) {
    case 5120:
      return values_of<std::int8_t>(*attribute, mesh.num_points());
    case 5121:
      return values_of<std::uint8_t>(*attribute, mesh.num_points());
    case 5122:
      return values_of<std::int16_t>(*attribute, mesh.num_points());
    case 5123:
      return values_of<std::uint16_t>(*attribute, mesh.num_points());
    case 5125:
      return values_of<std::uint32_t>(*attribute, mesh.num_points());
    default:
      return values_of<float>(*attribute, mesh.num_points());
  }
}

template <class Decoder>
void decode(std::span<const std::uint8_t> data, const DracoLimits& limits, draco::Mesh& mesh) {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(data.data()), data.size());
  const draco::Status status = Bounded<Decoder>(limits).Decode(draco::DecoderOptions(), &buffer, &mesh);
  if (!status.ok()) throw Fault{"is damaged"};
}

}  // namespace

DracoMesh decode_draco(std::span<const std::uint8_t> data, const std::vector<DracoAttribute>& wanted,
                       const DracoLimits& limits) {
  DracoMesh out;
  try {
    const Counts counts = read_counts(data);
    check_counts(counts, data.size(), limits);
    draco::Mesh mesh;
    if (counts.method == draco::MESH_SEQUENTIAL_ENCODING)
      decode<draco::MeshSequentialDecoder>(data, limits, mesh);
    else
      decode<draco::MeshEdgebreakerDecoder>(data, limits, mesh);
    out.vertices = mesh.num_points();
    out.indices.reserve(std::size_t{mesh.num_faces()} * 3);
    for (draco::FaceIndex f(0); f < mesh.num_faces(); ++f)
      for (const draco::PointIndex& corner : mesh.face(f)) out.indices.push_back(corner.value());
    for (const DracoAttribute& attribute : wanted) out.attributes.push_back(values_of(mesh, attribute));
  } catch (const Fault& fault) {
    out.fault = fault.reason;
    out.over_limit = fault.over_limit;
  }
  return out;
}

}  // namespace sheaf
