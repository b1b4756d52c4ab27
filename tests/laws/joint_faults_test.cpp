#include "tests/laws/joint_rig.hpp"
#include "tests/support/catch.hpp"

using namespace palpate::tests::joint;

namespace {

std::vector<Event> random_events(Random& random) {
    std::vector<Event> events(random.index(4));
    for (Event& event : events) {
        event = {.cause = static_cast<Cause>(random.below(static_cast<int>(Cause::count))),
                 .at = 1 + random.below(130),
                 .size = 1 + random.below(60)};
    }
    return events;
}

}  // namespace

TEST_CASE("whatever fails of board, wire, processes and screen together, the force ends in time",
          "[safety]") {
    palpate::tests::Tally tally;
    for (const std::uint64_t seed : palpate::tests::schedules(2000)) {
        Random random(seed);
        const bool open = random.coin();
        const auto events = random_events(random);
        const auto before = tally.broken;
        Rig(random, open).run(events, tally);
        ++tally.schedules;
        if (tally.broken != before) {
            tally.worst += fmt::format("\nseed {}, {}:", seed, open ? "open" : "Haply");
            for (const Event& event : events) {
                tally.worst += fmt::format(" cause {} at {} ({})", static_cast<int>(event.cause),
                                           event.at, event.size);
            }
        }
    }
    CAPTURE(tally.schedules, tally.tripped, tally.pressed, tally.broken, tally.worst);
    CHECK(tally.broken.empty());
    CHECK(tally.tripped > tally.schedules / 4);
    CHECK(tally.pressed > tally.schedules / 2);
}
