// Everything of ivory's OpenGL runtime. docs/runtime.md shows it in use.
//
// An asset is loaded from its file or uploaded from memory into a Gpu... struct that owns its OpenGL objects. From
// there it goes one of three ways:
//
//   the renderer    ambient(asset) makes an AmbientSource of it, which a DrawItem names; Renderer::draw() does the rest
//   your renderer   put #include "ambient/ASSET.glsl" into your fragment shader, resolve it with with_includes(), call
//                   ivory_ambient(p, ng, n) for E in lux, and bind(asset, program, unit) before drawing
//   your engine     take the .glsl functions alone (shader_source(), or the installed folder of them) and fill textures
//                   and structs as the files' opening comments say
//
// All functions need a current OpenGL 3.3 core context and throw ivory::Error: "<file>: <cause>; <remedy>".
#pragma once

#include "runtime/assets/ambient.h"          // IWYU pragma: export
#include "runtime/assets/cubemap.h"          // IWYU pragma: export
#include "runtime/assets/difmap.h"           // IWYU pragma: export
#include "runtime/assets/fiv.h"              // IWYU pragma: export
#include "runtime/assets/irradiance_grid.h"  // IWYU pragma: export
#include "runtime/assets/lobes.h"            // IWYU pragma: export
#include "runtime/assets/sh9.h"              // IWYU pragma: export
#include "runtime/gl/gl.h"                   // IWYU pragma: export
#include "runtime/gl/shader_source.h"        // IWYU pragma: export
#include "runtime/renderer/renderer.h"       // IWYU pragma: export
