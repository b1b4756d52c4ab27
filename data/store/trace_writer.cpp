#include "data/store/trace_writer.hpp"

#include <algorithm>
#include <bit>
#include <utility>

#include "engine/realtime/felt_scene.hpp"
#include "data/store/row.hpp"
#include "data/trace/chunk.hpp"
#include "data/trace/derived_hash.hpp"

namespace palpate::data {

TraceWriter::TraceWriter(Database& database,
                         std::optional<engine::PantographSpec> machine,
                         std::int64_t period_ns)
    : database_(database), machine_(std::move(machine)), period_ns_(period_ns) {
    ticks_.reserve(2 * kChunkTicks);
    parts_.reserve(2 * kChunkTicks);
}

TraceWriter::~TraceWriter() = default;

void TraceWriter::begin(std::int64_t trial,
                        std::int64_t interval,
                        std::unique_ptr<engine::FeltScene> scene) {
    trial_ = trial;
    interval_ = interval;
    scene_ = std::move(scene);
    retrace_ = std::make_unique<Retrace>(machine_, scene_.get());
    ticks_.clear();
    parts_.clear();
    unsaved_ = 0;
    row_there_ = false;
}

void TraceWriter::add(std::span<const engine::TickRecord> ticks) {
    ticks_.insert(ticks_.end(), ticks.begin(), ticks.end());
    unsaved_ += ticks.size();
}

bool TraceWriter::is_full() const noexcept {
    return ticks_.size() >= kChunkTicks;
}

void TraceWriter::write() {
    if (unsaved_ == 0) {
        return;
    }
    const std::size_t known = parts_.size();
    parts_.resize(ticks_.size(), kAllParts);
    retrace_->parts(std::span(ticks_).subspan(known), std::span(parts_).subspan(known));
    // Ticks that go back, were there any, must not replace what stands.
    for (std::size_t first = 0; first < ticks_.size(); first += kChunkTicks) {
        const std::size_t n = std::min(kChunkTicks, ticks_.size() - first);
        const auto ticks = std::span(ticks_).subspan(first, n);
        std::uint8_t parts = 0;
        for (const std::uint8_t of_tick : std::span(parts_).subspan(first, n)) {
            parts = static_cast<std::uint8_t>(parts | of_tick);
        }
        const std::int64_t first_tick = ticks.front().tick;
        const EncodedChunk chunk = encode_chunk(ticks, first_tick, period_ns_, parts);
        Row row("trace_chunk");
        row.set("trial_id", trial_)
            .set("interval", interval_)
            .set("first_tick", first_tick)
            .set("ticks", n)
            .set("codec", kTraceCodec)
            .set("period_ns", period_ns_)
            .set("holds", parts_text(parts))
            .set("crc32", chunk.crc32)
            .set("derived", std::bit_cast<std::int64_t>(derived_hash(ticks)))
            .set("data", chunk.data);
        if (first == 0 && row_there_) {
            row.update(database_, {"trial_id", "interval", "first_tick"});
        } else {
            row.insert(database_);
        }
    }
}

void TraceWriter::saved() {
    const auto full = static_cast<std::ptrdiff_t>(ticks_.size() / kChunkTicks * kChunkTicks);
    ticks_.erase(ticks_.begin(), ticks_.begin() + full);
    parts_.erase(parts_.begin(), parts_.begin() + full);
    unsaved_ = 0;
    row_there_ = !ticks_.empty();
}

}  // namespace palpate::data
