// The properties of glTF 2.0 and its extensions that ivory reads: types, ranges, targets.
#include "tracer/gltf/schema/tables.h"

namespace ivory::gltf {
namespace {

constexpr double byte_limit = 1e15;
constexpr bool required = true;
constexpr bool optional = false;

constexpr Field texture_transform[] = {
    {"offset", Kind::numbers, optional, -float_limit, float_limit, 2},
    {"rotation", Kind::number},
    {"scale", Kind::numbers, optional, -float_limit, float_limit, 2},
    {"texCoord", Kind::integer, optional, 0, 31},
};
constexpr Field texture_info_extensions[] = {
    {.name = "KHR_texture_transform", .kind = Kind::object, .schema = texture_transform}};
constexpr Field texture_info[] = {
    {.name = "index", .kind = Kind::index, .required = required, .target = "textures"},
    {"texCoord", Kind::integer, optional, 0, 31},
    {.name = "extensions", .kind = Kind::object, .schema = texture_info_extensions},
};
constexpr Field normal_texture_info[] = {
    {.name = "index", .kind = Kind::index, .required = required, .target = "textures"},
    {"texCoord", Kind::integer, optional, 0, 31},
    {"scale", Kind::number},
    {.name = "extensions", .kind = Kind::object, .schema = texture_info_extensions},
};

constexpr Field metallic_roughness[] = {
    {"baseColorFactor", Kind::numbers, optional, 0, 1, 4},
    {.name = "baseColorTexture", .kind = Kind::object, .schema = texture_info},
    {"metallicFactor", Kind::number, optional, 0, 1},
    {"roughnessFactor", Kind::number, optional, 0, 1},
    {.name = "metallicRoughnessTexture", .kind = Kind::object, .schema = texture_info},
};
constexpr Field specular_glossiness[] = {
    {"diffuseFactor", Kind::numbers, optional, 0, 1, 4},
    {.name = "diffuseTexture", .kind = Kind::object, .schema = texture_info},
    {"specularFactor", Kind::numbers, optional, 0, 1, 3},
    {"glossinessFactor", Kind::number, optional, 0, 1},
    {.name = "specularGlossinessTexture", .kind = Kind::object, .schema = texture_info},
};
constexpr Field specular[] = {
    {"specularFactor", Kind::number, optional, 0, 1},
    {.name = "specularTexture", .kind = Kind::object, .schema = texture_info},
    {"specularColorFactor", Kind::numbers, optional, 0, float_limit, 3},
    {.name = "specularColorTexture", .kind = Kind::object, .schema = texture_info},
};
constexpr Field transmission[] = {
    {"transmissionFactor", Kind::number, optional, 0, 1},
    {.name = "transmissionTexture", .kind = Kind::object, .schema = texture_info},
};
constexpr Field ior[] = {{"ior", Kind::number, optional, 0, float_limit}};
constexpr Field emissive_strength[] = {{"emissiveStrength", Kind::number, optional, 0, float_limit}};
constexpr Field material_extensions[] = {
    {.name = "KHR_materials_pbrSpecularGlossiness", .kind = Kind::object, .schema = specular_glossiness},
    {.name = "KHR_materials_specular", .kind = Kind::object, .schema = specular},
    {.name = "KHR_materials_transmission", .kind = Kind::object, .schema = transmission},
    {.name = "KHR_materials_ior", .kind = Kind::object, .schema = ior},
    {.name = "KHR_materials_emissive_strength", .kind = Kind::object, .schema = emissive_strength},
    {.name = "KHR_materials_unlit", .kind = Kind::object},
};
constexpr Field material[] = {
    {"name", Kind::string},
    {.name = "pbrMetallicRoughness", .kind = Kind::object, .schema = metallic_roughness},
    {.name = "normalTexture", .kind = Kind::object, .schema = normal_texture_info},
    {.name = "occlusionTexture", .kind = Kind::object, .schema = texture_info},
    {.name = "emissiveTexture", .kind = Kind::object, .schema = texture_info},
    {"emissiveFactor", Kind::numbers, optional, 0, float_limit, 3},
    {.name = "alphaMode", .kind = Kind::one_of, .one_of = "OPAQUE MASK BLEND"},
    {"alphaCutoff", Kind::number, optional, 0, float_limit},
    {"doubleSided", Kind::boolean},
    {.name = "extensions", .kind = Kind::object, .schema = material_extensions},
};

constexpr Field sparse_indices[] = {
    {.name = "bufferView", .kind = Kind::index, .required = required, .target = "bufferViews"},
    {"byteOffset", Kind::integer, optional, 0, 2147483647},
    {.name = "componentType", .kind = Kind::one_of, .required = required, .one_of = "5121 5123 5125"},
};
constexpr Field sparse_values[] = {
    {.name = "bufferView", .kind = Kind::index, .required = required, .target = "bufferViews"},
    {"byteOffset", Kind::integer, optional, 0, 2147483647},
};
constexpr Field sparse[] = {
    {"count", Kind::integer, required, 1, 2147483647},
    {.name = "indices", .kind = Kind::object, .required = required, .schema = sparse_indices},
    {.name = "values", .kind = Kind::object, .required = required, .schema = sparse_values},
};
constexpr Field accessor[] = {
    {"name", Kind::string},
    {.name = "bufferView", .kind = Kind::index, .target = "bufferViews"},
    {"byteOffset", Kind::integer, optional, 0, byte_limit},
    {.name = "componentType", .kind = Kind::one_of, .required = required, .one_of = "5120 5121 5122 5123 5125 5126"},
    {"normalized", Kind::boolean},
    {"count", Kind::integer, required, 1, 2147483647},
    {.name = "type", .kind = Kind::one_of, .required = required, .one_of = "SCALAR VEC2 VEC3 VEC4 MAT2 MAT3 MAT4"},
    {.name = "sparse", .kind = Kind::object, .schema = sparse},
};
constexpr Field meshopt[] = {
    {.name = "buffer", .kind = Kind::index, .required = required, .target = "buffers"},
    {"byteOffset", Kind::integer, optional, 0, byte_limit},
    {"byteLength", Kind::integer, required, 1, byte_limit},
    {"byteStride", Kind::integer, required, 1, 256},
    {"count", Kind::integer, required, 1, 2147483647},
    {.name = "mode", .kind = Kind::one_of, .required = required, .one_of = "ATTRIBUTES TRIANGLES INDICES"},
    {.name = "filter", .kind = Kind::one_of, .one_of = "NONE OCTAHEDRAL QUATERNION EXPONENTIAL"},
};
constexpr Field buffer_view_extensions[] = {
    {.name = "EXT_meshopt_compression", .kind = Kind::object, .schema = meshopt}};
constexpr Field buffer_view[] = {
    {.name = "buffer", .kind = Kind::index, .required = required, .target = "buffers"},
    {"byteOffset", Kind::integer, optional, 0, byte_limit},
    {"byteLength", Kind::integer, required, 1, byte_limit},
    {"byteStride", Kind::integer, optional, 4, 252},
    {.name = "extensions", .kind = Kind::object, .schema = buffer_view_extensions},
};
constexpr Field meshopt_buffer[] = {{"fallback", Kind::boolean}};
constexpr Field buffer_extensions[] = {
    {.name = "EXT_meshopt_compression", .kind = Kind::object, .schema = meshopt_buffer}};
constexpr Field buffer[] = {
    {"uri", Kind::string},
    {"byteLength", Kind::integer, required, 1, byte_limit},
    {.name = "extensions", .kind = Kind::object, .schema = buffer_extensions},
};

constexpr Field draco[] = {
    {.name = "bufferView", .kind = Kind::index, .required = required, .target = "bufferViews"},
    {.name = "attributes", .kind = Kind::index_map, .required = required},
};
constexpr Field primitive_extensions[] = {
    {.name = "KHR_draco_mesh_compression", .kind = Kind::object, .schema = draco}};
constexpr Field primitive[] = {
    {.name = "attributes", .kind = Kind::index_map, .required = required, .target = "accessors"},
    {.name = "indices", .kind = Kind::index, .target = "accessors"},
    {.name = "material", .kind = Kind::index, .target = "materials"},
    {"mode", Kind::integer, optional, 0, 6},
    {.name = "targets", .kind = Kind::index_maps, .target = "accessors"},
    {.name = "extensions", .kind = Kind::object, .schema = primitive_extensions},
};
constexpr Field mesh[] = {
    {"name", Kind::string},
    {.name = "primitives", .kind = Kind::objects, .required = required, .minimum = 1, .schema = primitive},
    {.name = "weights", .kind = Kind::numbers},
};

constexpr Field instancing[] = {
    {.name = "attributes", .kind = Kind::index_map, .required = required, .target = "accessors"}};
constexpr Field node_light[] = {{.name = "light", .kind = Kind::index, .required = required, .target = "lights"}};
constexpr Field node_visibility[] = {{"visible", Kind::boolean}};
constexpr Field node_extensions[] = {
    {.name = "EXT_mesh_gpu_instancing", .kind = Kind::object, .schema = instancing},
    {.name = "KHR_lights_punctual", .kind = Kind::object, .schema = node_light},
    {.name = "KHR_node_visibility", .kind = Kind::object, .schema = node_visibility},
};
constexpr Field node[] = {
    {"name", Kind::string},
    {.name = "camera", .kind = Kind::index, .target = "cameras"},
    {.name = "children", .kind = Kind::indices, .target = "nodes"},
    {.name = "mesh", .kind = Kind::index, .target = "meshes"},
    {.name = "skin", .kind = Kind::index, .target = "skins"},
    {"matrix", Kind::numbers, optional, -float_limit, float_limit, 16},
    {"rotation", Kind::numbers, optional, -1.01, 1.01, 4},
    {"scale", Kind::numbers, optional, -float_limit, float_limit, 3},
    {"translation", Kind::numbers, optional, -float_limit, float_limit, 3},
    {.name = "weights", .kind = Kind::numbers},
    {.name = "extensions", .kind = Kind::object, .schema = node_extensions},
};
constexpr Field skin[] = {
    {"name", Kind::string},
    {.name = "inverseBindMatrices", .kind = Kind::index, .target = "accessors"},
    {.name = "joints", .kind = Kind::indices, .required = required, .target = "nodes"},
};

constexpr Field animation_target[] = {
    {.name = "node", .kind = Kind::index, .target = "nodes"},
    {.name = "path", .kind = Kind::string, .required = required},
};
constexpr Field channel[] = {
    {.name = "sampler", .kind = Kind::index, .required = required},
    {.name = "target", .kind = Kind::object, .required = required, .schema = animation_target},
};
constexpr Field animation_sampler[] = {
    {.name = "input", .kind = Kind::index, .required = required, .target = "accessors"},
    {.name = "output", .kind = Kind::index, .required = required, .target = "accessors"},
    {.name = "interpolation", .kind = Kind::one_of, .one_of = "LINEAR STEP CUBICSPLINE"},
};
constexpr Field animation[] = {
    {"name", Kind::string},
    {.name = "channels", .kind = Kind::objects, .required = required, .minimum = 1, .schema = channel},
    {.name = "samplers", .kind = Kind::objects, .required = required, .minimum = 1, .schema = animation_sampler},
};

constexpr Field scene[] = {
    {"name", Kind::string},
    {.name = "nodes", .kind = Kind::indices, .target = "nodes"},
};

constexpr Field webp[] = {{.name = "source", .kind = Kind::index, .target = "images"}};
constexpr Field texture_extensions[] = {{.name = "EXT_texture_webp", .kind = Kind::object, .schema = webp}};
constexpr Field texture[] = {
    {.name = "sampler", .kind = Kind::index, .target = "samplers"},
    {.name = "source", .kind = Kind::index, .target = "images"},
    {.name = "extensions", .kind = Kind::object, .schema = texture_extensions},
};
constexpr Field sampler[] = {
    {.name = "magFilter", .kind = Kind::one_of, .one_of = "9728 9729"},
    {.name = "minFilter", .kind = Kind::one_of, .one_of = "9728 9729 9984 9985 9986 9987"},
    {.name = "wrapS", .kind = Kind::one_of, .one_of = "33071 33648 10497"},
    {.name = "wrapT", .kind = Kind::one_of, .one_of = "33071 33648 10497"},
};
constexpr Field image[] = {
    {"name", Kind::string},
    {"uri", Kind::string},
    {"mimeType", Kind::string},
    {.name = "bufferView", .kind = Kind::index, .target = "bufferViews"},
};

constexpr Field perspective[] = {
    {.name = "yfov",
     .kind = Kind::number,
     .required = required,
     .minimum = 0,
     .maximum = 3.1415926,
     .exclusive_minimum = true},
    {.name = "aspectRatio", .kind = Kind::number, .minimum = 0, .exclusive_minimum = true},
    {.name = "znear", .kind = Kind::number, .required = required, .minimum = 0, .exclusive_minimum = true},
    {.name = "zfar", .kind = Kind::number, .minimum = 0, .exclusive_minimum = true},
};
constexpr Field orthographic[] = {
    {.name = "xmag", .kind = Kind::number, .required = required, .minimum = 0, .exclusive_minimum = true},
    {.name = "ymag", .kind = Kind::number, .required = required, .minimum = 0, .exclusive_minimum = true},
    {.name = "znear", .kind = Kind::number, .required = required, .minimum = 0},
    {.name = "zfar", .kind = Kind::number, .required = required, .minimum = 0, .exclusive_minimum = true},
};
constexpr Field camera[] = {
    {"name", Kind::string},
    {.name = "type", .kind = Kind::one_of, .required = required, .one_of = "perspective orthographic"},
    {.name = "perspective", .kind = Kind::object, .schema = perspective},
    {.name = "orthographic", .kind = Kind::object, .schema = orthographic},
};

constexpr Field spot[] = {
    // Beyond a right angle and in the wrong order they are mended: nodes.cpp
    {"innerConeAngle", Kind::number, optional, 0, float_limit},
    {"outerConeAngle", Kind::number, optional, 0, float_limit},
};
constexpr Field light[] = {
    {"name", Kind::string},
    {.name = "type", .kind = Kind::string, .required = required},
    {"color", Kind::numbers, optional, 0, float_limit, 3},
    {"intensity", Kind::number, optional, 0, float_limit},
    {.name = "range", .kind = Kind::number, .minimum = 0, .exclusive_minimum = true},
    {.name = "spot", .kind = Kind::object, .schema = spot},
};
constexpr Field lights[] = {{.name = "lights", .kind = Kind::objects, .required = required, .schema = light}};
constexpr Field root_extensions[] = {{.name = "KHR_lights_punctual", .kind = Kind::object, .schema = lights}};

constexpr Field asset[] = {
    {.name = "version", .kind = Kind::string, .required = required},
    {"minVersion", Kind::string},
};
constexpr Field root[] = {
    {.name = "asset", .kind = Kind::object, .required = required, .schema = asset},
    {.name = "extensionsUsed", .kind = Kind::strings},
    {.name = "extensionsRequired", .kind = Kind::strings},
    {.name = "accessors", .kind = Kind::objects, .schema = accessor},
    {.name = "bufferViews", .kind = Kind::objects, .schema = buffer_view},
    {.name = "buffers", .kind = Kind::objects, .schema = buffer},
    {.name = "cameras", .kind = Kind::objects, .schema = camera},
    {.name = "images", .kind = Kind::objects, .schema = image},
    {.name = "materials", .kind = Kind::objects, .schema = material},
    {.name = "meshes", .kind = Kind::objects, .schema = mesh},
    {.name = "nodes", .kind = Kind::objects, .schema = node},
    {.name = "samplers", .kind = Kind::objects, .schema = sampler},
    {.name = "skins", .kind = Kind::objects, .schema = skin},
    {.name = "scene", .kind = Kind::index, .target = "scenes"},
    {.name = "scenes", .kind = Kind::objects, .schema = scene},
    {.name = "textures", .kind = Kind::objects, .schema = texture},
    {.name = "extensions", .kind = Kind::object, .schema = root_extensions},
};

constexpr Field animations[] = {{.name = "animations", .kind = Kind::objects, .schema = animation}};

}  // namespace

Schema root_schema() { return root; }
Schema animation_schema() { return animations; }

}  // namespace ivory::gltf
