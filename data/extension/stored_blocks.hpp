#pragma once

#include <memory>
#include <optional>

#include "engine/device/pantograph.hpp"
#include "data/extension/query.hpp"
#include "data/extension/tick_parts.hpp"
#include "data/trace/sample_columns.hpp"

namespace palpate::data {

/// Columns that chunks hold, and HIP from the encoder counts: chunk by chunk without any replay, decoding
/// the columns wanted only, those chunks left out that are out of range.
/// @param machine  what HIP follows from, if columns of HIP are wanted and the session has a calibration
[[nodiscard]] std::unique_ptr<TickBlocks> stored_blocks(
    Asked& db,
    const TrialPart& part,
    SampleColumns columns,
    const TickRange& range,
    const std::optional<engine::PantographSpec>& machine);

}  // namespace palpate::data
