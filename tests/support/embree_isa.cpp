// Preloaded where tests ask what a CPU with other vector instructions would give: every Embree device is made with the
// configuration of EMBREE_CONFIG, e.g. "isa=avx2".
#include <cstdlib>

#include <dlfcn.h>

extern "C" void* rtcNewDevice(const char* config) {
  using NewDevice = void* (*)(const char*);
  static const auto original = reinterpret_cast<NewDevice>(dlsym(RTLD_NEXT, "rtcNewDevice"));
  const char* chosen = std::getenv("EMBREE_CONFIG");
  return original(chosen != nullptr ? chosen : config);
}
