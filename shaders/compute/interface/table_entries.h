// Pass table_entries: new blocks' slots into the page table.
#ifndef ROSEFUSION_INTERFACE_TABLE_ENTRIES_H
#define ROSEFUSION_INTERFACE_TABLE_ENTRIES_H
#include "shaders/compute/interface/types.h"
#ifdef __cplusplus
namespace rosefusion::shader {
#endif

const uint kTableEntriesGroup = 64u;       // invocations, one per entry
const uint kTableEntriesBindEntries = 0u;  // TableEntry
const uint kTableEntriesBindTable = 1u;
const uint kTableEntriesBindRequests = 2u;  // the table in which blocks are requested
const uint kTableEntriesBindings = 3u;

struct TableEntry {
  uint entry;  // number in the table
  uint slot;
};

struct TableEntriesParams {
  uint count;
};

#ifdef __cplusplus
}  // namespace rosefusion::shader
#endif
#endif
