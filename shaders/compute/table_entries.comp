#version 450
#extension GL_GOOGLE_include_directive : require
// Writes new blocks' slots into both page tables, so that no frame copies a table as a whole.
#include "shaders/compute/interface/table_entries.h"
#include "shaders/compute/lib/parameters.glsl"

layout(local_size_x = kTableEntriesGroup) in;
PUSHED_PARAMETERS(TableEntriesParams)
layout(std430, binding = kTableEntriesBindEntries) readonly restrict buffer Entries { TableEntry entries[]; };
layout(std430, binding = kTableEntriesBindTable) writeonly restrict buffer Table { uint table[]; };
layout(std430, binding = kTableEntriesBindRequests) writeonly restrict buffer Requests { uint requests[]; };

void main() {
  uint i = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * kTableEntriesGroup + gl_LocalInvocationID.x;
  if (i >= params.count) return;
  TableEntry at = entries[i];
  table[at.entry] = at.slot;
  requests[at.entry] = at.slot;
}
