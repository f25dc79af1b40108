// The compact leak guard of a grid's vertex: up to four planes in four words. Twin of grid/field/guard.cpp.

// One plane from its word (10 + 10 bits octahedral normal, 12 bits distance): unit normal in xyz, distance in voxels in
// w. A word whose distance is zero is no plane; what it unpacks to has no meaning.
const uint ivory_no_guard_plane = 0x100000u;
vec4 ivory_guard_unpack(uint word) {
  vec3 n;
  n.xy = vec2(uvec2(word, word >> 10u) & 1023u) * (2.0 / 1023.0) - 1.0;
  n.z = 1.0 - abs(n.x) - abs(n.y);
  // Where z < 0 the octahedron's corner is folded over: x becomes (1 - |y|) sgn x = x + z sgn x, y likewise.
  float fold = min(n.z, 0.0);
  n.xy += vec2(n.x < 0.0 ? -fold : fold, n.y < 0.0 ? -fold : fold);
  float distance_voxels = (float(word >> 20u) - 1.0) * (4.0 / 4094.0) - 2.0;
  return vec4(n * inversesqrt(dot(n, n)), distance_voxels);
}

// Did any light come to the vertex? The order of the words says so: runtime/assets/irradiance_grid.cpp.
bool ivory_guard_lit(uvec4 record) { return record.x >= record.w; }

// The record's planes as columns: vec4(u, -1) times it says how far u lies beyond each, very negative for none.
vec4 ivory_guard_plane(uint word) {
  return word < ivory_no_guard_plane ? vec4(0.0, 0.0, 0.0, 3.402823e38) : ivory_guard_unpack(word);
}
mat4 ivory_unpacked_guard(uvec4 record) {
  return mat4(ivory_guard_plane(record.x), ivory_guard_plane(record.y), ivory_guard_plane(record.z),
              ivory_guard_plane(record.w));
}

// How far, in voxels, the point at offset u (voxels, along the grid's axes) from the vertex lies beyond the plane that
// hides it most: positive where the vertex does not see it, very negative where no plane is set.
float ivory_hidden_by(mat4 planes, vec3 u) {
  vec4 beyond = vec4(u, -1.0) * planes;
  return max(max(beyond.x, beyond.y), max(beyond.z, beyond.w));
}
