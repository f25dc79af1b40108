// How much may be asked of this machine, as this process is let: in containers and batch queues less than it has.
#pragma once

#include <string>

namespace ivory {

// What Linux' control groups grant the calling process and those above it in their tree; infinite where nothing limits
// it.
struct ControlGroupLimits {
  double memory_bytes;
  double processors;  // processor time a unit of time
};

// Version 2 (memory.max, cpu.max) and version 1 (memory.limit_in_bytes, cpu.cfs_quota_us). `root` stands before "/proc"
// and "/sys". What cannot be read limits nothing.
ControlGroupLimits control_group_limits(const std::string& root = "");

// The least of the machine's memory, the control groups' limit and the address space that ulimit -v leaves.
double available_memory_bytes();

// Processors that this process may keep busy, at least 1: those it may run on (affinity), and the control groups' share
// of their time, rounded up.
int available_processors();

// Throws Error(file, "needs N GiB of memory, and M GiB may be used", remedy) for more than three quarters of
// available_memory_bytes(): to be asked before an allocation whose size a user or a file decides, because Linux
// promises memory that it does not have and ends the program when that is used.
void check_memory(const std::string& file, double bytes, const std::string& remedy);

}  // namespace ivory
