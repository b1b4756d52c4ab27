#include "engine/device/drivers/haply_line.hpp"
#include "engine/device/open/open_line.hpp"
#include "tests/firmware/boards.hpp"
#include "tests/support/board_link.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/miswired_machine.hpp"

using namespace palpate::engine;

// The same miswirings on both kinds of boards, by the driver that a session uses, on the board's
// own clock.

namespace {

Calibration machine_of(bool open) {
    return open ? open_machine() : emulated_calibration("gen3");
}

template <class Board>
CommissioningResult commissioned_on(Board& board,
                                    MiswiredHandle& handle,
                                    const Calibration& machine,
                                    MakeLine make_line) {
    static const std::vector<Vec3> places = places_to_commission(machine, *machine.home);
    BoardDesk desk(board, make_line);
    desk.open(machine);
    const auto bring = [&](const Vec3& place) {
        handle.bring(Vec2(place));
        desk.cable.pass(200'000'000);
    };
    return commission(*desk.device, machine, places, Vec3(PlantModel{}.handle_mass),
                      attended(bring, [&] { desk.pass_tick(); }));
}

CommissioningResult commissioned_on_board(bool open,
                                          const Connection& encoders,
                                          const Connection& motors,
                                          double& asked) {
    const Calibration machine = machine_of(open);
    MiswiredHandle handle(machine, encoders, motors);
    CommissioningResult done;
    if (open) {
        OpenBoard board = OnHost::make(handle, machine);
        done = commissioned_on(board, handle, machine, open_line);
    } else {
        HaplyBoard board(handle, machine.pantograph, *machine.haply);
        done = commissioned_on(board, handle, machine, haply_line);
    }
    asked = handle.asked;
    return done;
}

/// Every swap and sign, and every gain of one that is otherwise right. All 72 come with a tag.
std::vector<Connection> wrong_connections(bool all) {
    std::vector<Connection> wrong;
    for (const Connection& one : all_connections()) {
        const auto right = [&](std::size_t i) {
            return one.factor[i] == 1.0;
        };
        const bool signs = std::fabs(one.factor[0]) == 1.0 && std::fabs(one.factor[1]) == 1.0;
        const bool gain =
            !one.swapped && (right(0) || right(1)) && one.factor[0] > 0.0 && one.factor[1] > 0.0;
        if (!(one == Connection{}) && (all || signs || gain)) {
            wrong.push_back(one);
        }
    }
    return wrong;
}

void find_all(bool open, bool all) {
    double asked = 0.0;
    const CommissioningResult right = commissioned_on_board(open, {}, {}, asked);
    CHECK(right.refused.empty());
    CHECK(right.record.dynamics.handle_mass == Approx(PlantModel{}.handle_mass).epsilon(0.1));
    for (const Connection& wrong : wrong_connections(all)) {
        CAPTURE(open, wrong.swapped, wrong.factor[0], wrong.factor[1]);
        const CommissioningResult encoders =
            commissioned_on_board(open, wrong, {.swapped = true, .factor = {-2.0, 0.5}}, asked);
        CHECK_THAT(encoders.refused, Has("encoder"));
        CHECK(asked == 0.0);
        const CommissioningResult motors = commissioned_on_board(open, {}, wrong, asked);
        CHECK_FALSE(motors.refused.empty());
        CHECK(misnamed(motors.refused, wrong) == "");
    }
}

}  // namespace

TEST_CASE("every miswiring of an emulated Haply or open board is found and named",
          "[haply][open]") {
    find_all(GENERATE(false, true), false);
}

TEST_CASE("every miswiring of both boards, all 71 of encoders and all 71 of motors",
          "[.all-miswirings]") {
    find_all(GENERATE(false, true), true);
}
