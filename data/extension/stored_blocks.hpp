#pragma once

#include <memory>
#include <optional>

#include "engine/device/pantograph.hpp"
#include "data/extension/query.hpp"
#include "data/extension/tick_parts.hpp"
#include "data/trace/sample_columns.hpp"

namespace palpate::data {

/// What HIP follows from, if columns of HIP are wanted.
struct HipSource {
    std::optional<engine::PantographSpec> machine{};  ///< if the session has a calibration
    bool in_space = false;                            ///< from its own columns
};

/// Columns that chunks hold, and HIP from the encoder counts: chunk by chunk without any replay,
/// decoding the columns wanted only, those chunks left out that are out of range.
[[nodiscard]] std::unique_ptr<TickBlocks> stored_blocks(StatementCache& db,
                                                        const TrialPart& part,
                                                        SampleColumns columns,
                                                        const TickRange& range,
                                                        const HipSource& source);

}  // namespace palpate::data
