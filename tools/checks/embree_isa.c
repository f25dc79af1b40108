// Preloaded by tools/check: every Embree device is made with the configuration of EMBREE_CONFIG, e.g. "isa=avx2".
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdlib.h>

void* rtcNewDevice(const char* config) {
  void* (*original)(const char*) = (void* (*)(const char*))dlsym(RTLD_NEXT, "rtcNewDevice");
  const char* chosen = getenv("EMBREE_CONFIG");
  return original(chosen ? chosen : config);
}
