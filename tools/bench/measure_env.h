// A synthetic environment, and the least that any method has to do with one.
#pragma once

#include <vector>

#include "grid/env/environment_image.h"

namespace ivory {

// A lat-long map without any symmetry.
EnvironmentImage make_bench_environment(int width, int height);

// Every pixel read once and added up in double, on TBB's threads.
V3d sum_pixels(const EnvironmentImage& latlong);

// Bytes from one array into another of as many, as STREAM's copy does, on TBB's threads.
void copy_bytes(const std::vector<float>& from, std::vector<float>& to);

}  // namespace ivory
