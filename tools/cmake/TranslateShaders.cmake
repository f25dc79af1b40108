# Translates ambient/KIND.glsl of FOLDER for each of the list KINDS into OUTPUT: KIND.spv (SPIR-V for OpenGL), KIND.json
# (its uniforms' names, locations and bindings), KIND.hlsl (shader model 5) and KIND.es.glsl (GLSL ES 3.00, where it has
# no buffer textures, which 3.00 lacks). Each has ivory_ambient() and an entry point that reads a fragment's position and
# normals. GLSLANG and SPIRV_CROSS are the programs.

cmake_minimum_required(VERSION 3.25)

# Sets `result` to the text with its #include lines resolved, each file once, as runtime/gl/shader_source.cpp does it.
function(resolve_includes text result)
  set(done "")
  while(text MATCHES "#include \"([^\"]+)\"\n")
    set(line "${CMAKE_MATCH_0}")
    set(name "${CMAKE_MATCH_1}")
    string(FIND "${text}" "${line}" begin)
    string(LENGTH "${line}" length)
    math(EXPR end "${begin} + ${length}")
    string(SUBSTRING "${text}" 0 ${begin} before)
    string(SUBSTRING "${text}" ${end} -1 after)
    set(included "")
    if(NOT name IN_LIST done)
      list(APPEND done ${name})
      file(READ ${FOLDER}/${name} included)
    endif()
    set(text "${before}${included}${after}")
  endwhile()
  set(${result} "${text}" PARENT_SCOPE)
endfunction()

function(run)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE code OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT code EQUAL 0)
    message(FATAL_ERROR "${ARGV}\n${output}")
  endif()
endfunction()

file(MAKE_DIRECTORY ${OUTPUT})
foreach(kind IN LISTS KINDS)
  resolve_includes("#version 450
#include \"ambient/${kind}.glsl\"

layout(location = 0) in vec3 ivory_in_position;  // world, m
layout(location = 1) in vec3 ivory_in_geometric_normal;
layout(location = 2) in vec3 ivory_in_shading_normal;
layout(location = 0) out vec4 ivory_out_irradiance;  // lux

void main() {
  ivory_out_irradiance =
      vec4(ivory_ambient(ivory_in_position, ivory_in_geometric_normal, ivory_in_shading_normal), 1.0);
}
" source)
  set(path ${OUTPUT}/${kind})
  file(WRITE ${path}.frag "${source}")
  # Names stay (-g); OpenGL wants a location for each uniform and a binding for each texture.
  run(${GLSLANG} -G -g --auto-map-locations --auto-map-bindings -o ${path}.spv ${path}.frag)
  run(${SPIRV_CROSS} ${path}.spv --reflect --output ${path}.json)
  run(${SPIRV_CROSS} ${path}.spv --hlsl --shader-model 50 --output ${path}.hlsl)
  file(REMOVE ${path}.frag ${path}.es.glsl)
  if(NOT source MATCHES "samplerBuffer")
    run(${SPIRV_CROSS} ${path}.spv --es --version 300 --output ${path}.es.glsl)
  endif()
endforeach()
