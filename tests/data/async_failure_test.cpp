#include "data/store/async_recorder.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/studies.hpp"

namespace {

/// A disk that fails once, and would take everything after it.
class DiskWithHiccup : public tests::NoRecorder {
public:
    explicit DiskWithHiccup(int failing) : failing_(failing) {}
    protocols::TrialId begin_trial(const protocols::PlannedTrial& /*p*/) override {
        return ++calls_;
    }
    void append(protocols::TrialId /*t*/, std::span<const engine::TickRecord> ticks) override {
        ++calls_;
        if (++appends_ == failing_) {
            throw data::StoreError("the disk did not take it");
        }
        last_ = ticks.back().tick;
    }
    void end_trial(protocols::TrialId /*t*/, const protocols::TrialResult& /*r*/) override {
        ++calls_;
    }
    void event(const protocols::Event& /*event*/) override { ++calls_; }
    void finish_session() override { ++calls_; }

    [[nodiscard]] int calls() const { return calls_; }
    [[nodiscard]] std::int64_t last_tick() const { return last_; }

private:
    int failing_;
    int appends_ = 0;
    int calls_ = 0;
    std::int64_t last_ = -1;
};

constexpr std::int64_t kPart = 1000;  ///< ticks that are not kept to be handed over with more

/// @returns whether one part was refused
bool append_all(protocols::Recorder& recorder, std::int64_t parts) {
    try {
        for (std::int64_t i = 0; i < parts; ++i) {
            recorder.append(1, tests::random_ticks(1, kPart, i * kPart));
        }
    } catch (const data::StoreError&) {
        return true;
    }
    return false;
}

}  // namespace

TEST_CASE("after one lost append nothing is stored any more, and every call says so",
          "[store][law]") {
    const int failing = GENERATE(1, 2, 7, 20);
    CAPTURE(failing);
    constexpr std::int64_t kParts = 20;
    DiskWithHiccup disk(failing);
    {
        data::AsyncRecorder recorder(disk);
        const auto id = recorder.begin_trial({});
        const bool refused = append_all(recorder, kParts);
        CAPTURE(refused);
        const std::function<void()> calls[] = {
            [&] { recorder.end_trial(id, tests::answered(0, true)); },
            [&] { recorder.append(id, tests::random_ticks(1, 10, kParts * kPart)); },
            [&] { recorder.event({.text = "somebody noted it"}); },
            [&] { static_cast<void>(recorder.begin_trial({})); },
            [&] {
                recorder.finish_session();
            }};
        for (int round = 0; round < 3; ++round) {
            for (const auto& call : calls) {
                CHECK_THROWS_WITH(call(), Has("did not take it"));
            }
        }
    }
    CHECK(disk.calls() == 1 + failing);  // begin_trial and the appends up to the lost one
    CHECK(disk.last_tick() == (failing - 1) * kPart - 1);
}
