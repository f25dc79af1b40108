#include "tracer/gltf/accessors.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>

#include <fmt/format.h>

namespace ivory::gltf {
namespace {

std::size_t component_bytes(int component_type) {
  return std::size_t(tinygltf::GetComponentSizeInBytes(std::uint32_t(component_type)));
}

// Columns of matrices start at multiples of four bytes; only instancing could ask for one, and does
// not, so a matrix counts as its plain components.
std::size_t element_bytes(const tinygltf::Accessor& accessor) {
  return component_bytes(accessor.componentType) *
         std::size_t(tinygltf::GetNumComponentsInType(std::uint32_t(accessor.type)));
}

void check_range(const Document& document, int view, std::size_t offset, std::size_t count, std::size_t element,
                 std::size_t stride, const std::string& what) {
  const std::size_t size = document.model.bufferViews[std::size_t(view)].byteLength;
  // (count - 1) stride + element <= size - offset, without overflow
  const bool fits = offset <= size && element <= size - offset && (count - 1) <= (size - offset - element) / stride;
  if (!fits) {
    document.fail(fmt::format("{} reaches beyond bufferViews[{}] ({} elements of {} bytes, {} bytes there)", what, view,
                              count, element, size),
                  remedy);
  }
}

void check_accessor(Document& document, std::size_t index) {
  const tinygltf::Accessor& accessor = document.model.accessors[index];
  const std::string what = label("accessors", index, accessor.name);
  const std::size_t element = element_bytes(accessor);
  const std::size_t component = component_bytes(accessor.componentType);
  if (accessor.bufferView >= 0) {
    const tinygltf::BufferView& view = document.model.bufferViews[std::size_t(accessor.bufferView)];
    const std::size_t stride = view.byteStride == 0 ? element : view.byteStride;
    if (stride < element)
      document.fail(fmt::format("{} has elements of {} bytes in steps of {}", what, element, stride), remedy);
    check_range(document, accessor.bufferView, accessor.byteOffset, accessor.count, element, stride, what);
    if ((view.byteOffset + accessor.byteOffset) % component != 0 || stride % component != 0)
      document.warn(what + " is not aligned to its component size");
  } else {
    if (accessor.byteOffset != 0) document.fail(what + " has an offset into no buffer view", remedy);
    // Zeros take no bytes in the file, but they do in memory.
    if (accessor.count > document.bytes_read + (1U << 20U))
      document.fail(fmt::format("{} claims {} elements without data", what, accessor.count), remedy);
  }
  if (accessor.normalized && (accessor.componentType == TINYGLTF_COMPONENT_TYPE_FLOAT ||
                              accessor.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT))
    document.fail(what + " is normalized, which its component type cannot be", remedy);
  if (accessor.sparse.isSparse) {
    const auto& sparse = accessor.sparse;
    const std::size_t count = std::size_t(sparse.count);
    if (count > accessor.count)
      document.fail(fmt::format("{} replaces {} of {} elements", what, count, accessor.count), remedy);
    const std::size_t index_bytes = component_bytes(sparse.indices.componentType);
    check_range(document, sparse.indices.bufferView, std::size_t(sparse.indices.byteOffset), count, index_bytes,
                index_bytes, what + " (sparse indices)");
    check_range(document, sparse.values.bufferView, std::size_t(sparse.values.byteOffset), count, element, element,
                what + " (sparse values)");
  }
}

const std::uint8_t* view_data(const Document& document, int view, const std::string& what) {
  const auto bytes = document.views[std::size_t(view)];
  if (bytes.empty())
    document.fail(fmt::format("{} needs bufferViews[{}], whose buffer has no data", what, view), remedy);
  return bytes.data();
}

template <class T>
float to_float(T value, bool normalized) {
  if constexpr (std::is_same_v<T, float>) {
    return value;
  } else {
    if (!normalized) return float(value);
    return std::max(float(value) / float(std::numeric_limits<T>::max()), -1.0F);
  }
}

template <class T, int n>
void convert(const std::uint8_t* source, std::size_t stride, std::size_t count, bool normalized, float* out) {
  for (std::size_t i = 0; i < count; ++i, source += stride, out += n) {
    T values[n];
    std::memcpy(values, source, sizeof values);
    for (int k = 0; k < n; ++k) out[k] = to_float(values[k], normalized);
  }
}

template <int n>
void convert(int component_type, const std::uint8_t* source, std::size_t stride, std::size_t count, bool normalized,
             float* out) {
  switch (component_type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return convert<std::int8_t, n>(source, stride, count, normalized, out);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return convert<std::uint8_t, n>(source, stride, count, normalized, out);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return convert<std::int16_t, n>(source, stride, count, normalized, out);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return convert<std::uint16_t, n>(source, stride, count, normalized, out);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return convert<std::uint32_t, n>(source, stride, count, normalized, out);
    default:
      return convert<float, n>(source, stride, count, normalized, out);
  }
}

void read_unsigned(int component_type, const std::uint8_t* source, std::size_t stride, std::size_t count,
                   std::uint32_t* out) {
  const std::size_t bytes = component_bytes(component_type);
  if (bytes == 4 && stride == 4) {
    std::memcpy(out, source, count * 4);
    return;
  }
  for (std::size_t i = 0; i < count; ++i, source += stride) {
    // Little endian, as is every host that Embree runs on.
    std::uint32_t value = 0;
    std::memcpy(&value, source, bytes);
    out[i] = value;
  }
}

std::vector<std::uint32_t> sparse_indices(const Document& document, const tinygltf::Accessor& accessor,
                                          const std::string& what) {
  const auto& sparse = accessor.sparse;
  std::vector<std::uint32_t> indices(std::size_t(sparse.count));
  read_unsigned(sparse.indices.componentType,
                view_data(document, sparse.indices.bufferView, what) + sparse.indices.byteOffset,
                component_bytes(sparse.indices.componentType), indices.size(), indices.data());
  for (const std::uint32_t index : indices) {
    if (index >= accessor.count) {
      document.fail(fmt::format("{} has a sparse index {} beyond its {} elements", what, index, accessor.count),
                    remedy);
    }
  }
  return indices;
}

// The elements from `first` on, `count` of them, as n floats each.
template <int n>
void read_elements(const Document& document, int index, const std::string& what, std::size_t first, std::size_t count,
                   float* out) {
  const tinygltf::Accessor& accessor = document.model.accessors[std::size_t(index)];
  if (accessor.bufferView >= 0) {
    const tinygltf::BufferView& view = document.model.bufferViews[std::size_t(accessor.bufferView)];
    const std::size_t stride = view.byteStride == 0 ? element_bytes(accessor) : view.byteStride;
    const std::uint8_t* source = view_data(document, accessor.bufferView, what) + accessor.byteOffset + first * stride;
    convert<n>(accessor.componentType, source, stride, count, accessor.normalized, out);
  }
  if (accessor.sparse.isSparse) {
    const std::vector<std::uint32_t> places = sparse_indices(document, accessor, what);
    std::vector<float> values(places.size() * n);
    convert<n>(accessor.componentType,
               view_data(document, accessor.sparse.values.bufferView, what) + accessor.sparse.values.byteOffset,
               element_bytes(accessor), places.size(), accessor.normalized, values.data());
    for (std::size_t i = 0; i < places.size(); ++i) {
      if (places[i] >= first && places[i] - first < count)
        std::copy_n(&values[i * n], n, out + (places[i] - first) * n);
    }
  }
  for (std::size_t i = 0; i < count * n; ++i) {
    if (!std::isfinite(out[i]))
      document.fail(fmt::format("{} (accessors[{}]) is not finite at element {}", what, index, first + i / n), remedy);
  }
}

void check_components(const Document& document, int index, const std::string& what, int components) {
  const tinygltf::Accessor& accessor = document.model.accessors[std::size_t(index)];
  if (tinygltf::GetNumComponentsInType(std::uint32_t(accessor.type)) != components ||
      accessor.type == TINYGLTF_TYPE_MAT2) {
    document.fail(fmt::format("{} (accessors[{}]) does not have {} component{}", what, index, components,
                              components == 1 ? "" : "s"),
                  remedy);
  }
}

// Vectors of n floats without padding, as all of Imath's are.
template <class Vector, int n>
std::vector<Vector> read_vectors(const Document& document, int index, const std::string& what, const Range& range) {
  static_assert(sizeof(Vector) == n * sizeof(float));
  check_components(document, index, what, n);
  const std::size_t elements = document.model.accessors[std::size_t(index)].count;
  const std::size_t first = std::min(range.first, elements);
  const std::size_t count = std::min(range.count, elements - first);
  std::vector<Vector> result(count, Vector(0));
  if (count > 0) read_elements<n>(document, index, what, first, count, &result[0].x);
  return result;
}

}  // namespace

void check_accessors(Document& document) {
  for (std::size_t i = 0; i < document.model.accessors.size(); ++i) check_accessor(document, i);
}

std::vector<V2f> read_vec2(const Document& document, int accessor, const std::string& what, const Range& range) {
  return read_vectors<V2f, 2>(document, accessor, what, range);
}

std::vector<V3f> read_vec3(const Document& document, int accessor, const std::string& what, const Range& range) {
  return read_vectors<V3f, 3>(document, accessor, what, range);
}

std::vector<V4f> read_vec4(const Document& document, int accessor, const std::string& what, const Range& range) {
  return read_vectors<V4f, 4>(document, accessor, what, range);
}

std::vector<float> read_floats(const Document& document, int accessor, int components, const std::string& what) {
  check_components(document, accessor, what, components);
  const std::size_t count = document.model.accessors[std::size_t(accessor)].count;
  std::vector<float> result(count * std::size_t(components), 0.0F);
  if (components == 1) read_elements<1>(document, accessor, what, 0, count, result.data());
  if (components == 3) read_elements<3>(document, accessor, what, 0, count, result.data());
  if (components == 4) read_elements<4>(document, accessor, what, 0, count, result.data());
  if (components == 16) read_elements<16>(document, accessor, what, 0, count, result.data());
  return result;
}

std::vector<std::uint32_t> read_indices(const Document& document, int index, const std::string& what) {
  const tinygltf::Accessor& accessor = document.model.accessors[std::size_t(index)];
  const int type = accessor.componentType;
  const bool integer = type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
                       type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT || type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
  if (accessor.type != TINYGLTF_TYPE_SCALAR || !integer || accessor.normalized)
    document.fail(fmt::format("{} (accessors[{}]) does not hold unsigned integers", what, index), remedy);
  std::vector<std::uint32_t> result(accessor.count, 0);
  if (accessor.bufferView >= 0) {
    const tinygltf::BufferView& view = document.model.bufferViews[std::size_t(accessor.bufferView)];
    read_unsigned(type, view_data(document, accessor.bufferView, what) + accessor.byteOffset,
                  view.byteStride == 0 ? element_bytes(accessor) : view.byteStride, accessor.count, result.data());
  }
  if (accessor.sparse.isSparse) {
    const std::vector<std::uint32_t> places = sparse_indices(document, accessor, what);
    std::vector<std::uint32_t> values(places.size());
    read_unsigned(type,
                  view_data(document, accessor.sparse.values.bufferView, what) + accessor.sparse.values.byteOffset,
                  element_bytes(accessor), places.size(), values.data());
    for (std::size_t i = 0; i < places.size(); ++i) result[places[i]] = values[i];
  }
  // glTF 2.0, section 3.7.2.1: the largest value would restart a primitive.
  const std::uint32_t restart = 0xFFFFFFFFU >> (32 - 8 * component_bytes(type));
  if (std::find(result.begin(), result.end(), restart) != result.end())
    document.fail(fmt::format("{} (accessors[{}]) holds the primitive restart value {}", what, index, restart), remedy);
  return result;
}

}  // namespace ivory::gltf
