#include "protocols/file/calibration_keys.hpp"

#include <array>

namespace palpate::protocols {

using engine::Calibration;

template <>
Calibration& record_at<Calibration>(void* record) {
    static Calibration begun = begun_pantograph();
    return record == nullptr ? begun : *static_cast<Calibration*>(record);
}

namespace {

constexpr double kMilli = 1000.0;  // mm, mN m
constexpr std::array<std::string_view, 2> kSides{"right", "left"};
constexpr std::array<std::string_view, 2> kWays{"anticlockwise", "clockwise"};
constexpr std::array<std::string_view, 2> kSenses{"forward", "backward"};

// What a desk-top machine can be, as check() of the engine has it.
constexpr Range kLength{.min = 0.0, .max = 2000.0, .above = true};
constexpr Range kTorque{.min = 0.0, .max = 2000.0, .above = true};
constexpr Range kPort{.min = 1.0, .max = 2.0};
constexpr Range kEnd{.min = -2000.0, .max = 2000.0};
constexpr Range kChannel{.min = 0.0, .max = 65535.0};
constexpr Range kVolts{.min = -1000.0, .max = 1000.0};

/// The second word stands for true.
template <const auto& kWords, auto Member, auto... Deeper>
Slot is(void* record) {
    return OneOf{kWords, whole_of(part_of<Member, Deeper...>(record_at<OwnerOf<Member>>(record)))};
}

using engine::AxisDynamics;
using engine::ComediWiring;
using engine::FiveBar;
using engine::GantrySpec;
using engine::HandleDynamics;
using engine::HaplyWiring;
using engine::OpenWiring;
using engine::PantographSpec;
using engine::StraightAxis;
using enum Need;

// clang-format off
constexpr Key kPantograph[]{
    {.name = "name", .slot = at<&Calibration::pantograph, &PantographSpec::name>, .need = required, .form = Form::any,
     .meaning = "of the machine, 1 to 64 bytes"},
    {.name = "origin_mm", .slot = at<&Calibration::pantograph, &PantographSpec::origin>, .per_si = kMilli,
     .meaning = "the object frame's origin in the linkage's frame, whose x axis leads from pivot 1 to pivot 2"},
    {.name = "turn_deg", .slot = at<&Calibration::pantograph, &PantographSpec::turn>, .range = {-360, 360}, .per_si = kDegrees,
     .meaning = "from the linkage's x axis to the object frame's"},
    {.name = "home_mm", .slot = at<&Calibration::home>, .per_si = kMilli,
     .meaning = "rest pose of the handle when the device is switched on; left out: by hand"},
    {.name = "damping_n_s_per_m", .slot = at<&Calibration::pantograph, &PantographSpec::damping>, .range = {0, 100},
     .meaning = "of the machine at its handle, the least where objects are felt"},
    {.name = "motor_time_s", .slot = at<&Calibration::pantograph, &PantographSpec::motor_time>, .range = {0, 1e5},
     .meaning = "thermal time constant of the motors; 0: not known"},
    {.name = "clearance_mm", .slot = at<&Calibration::pantograph, &PantographSpec::clearance>, .range = {0, 50, true}, .per_si = kMilli,
     .meaning = "poses closer to a singular one are refused"},
};

constexpr Key kLinkage[]{
    {.name = "driven_1_mm", .slot = at<&FiveBar::driven_1>, .need = required, .range = kLength, .per_si = kMilli,
     .meaning = "link at pivot 1"},
    {.name = "driven_2_mm", .slot = at<&FiveBar::driven_2>, .need = required, .range = kLength, .per_si = kMilli,
     .meaning = "link at pivot 2"},
    {.name = "free_1_mm", .slot = at<&FiveBar::free_1>, .need = required, .range = kLength, .per_si = kMilli,
     .meaning = "from elbow 1 to the handle"},
    {.name = "free_2_mm", .slot = at<&FiveBar::free_2>, .need = required, .range = kLength, .per_si = kMilli,
     .meaning = "from elbow 2 to the handle"},
    {.name = "base_mm", .slot = at<&FiveBar::base>, .need = required, .range = {0, 2000}, .per_si = kMilli,
     .meaning = "between the pivots"},
    {.name = "elbow_1", .slot = is<kSides, &FiveBar::mode, &engine::WorkingMode::elbow_1_left>,
     .meaning = "side of the line from pivot 1 to the handle"},
    {.name = "elbow_2", .slot = is<kSides, &FiveBar::mode, &engine::WorkingMode::elbow_2_left>,
     .meaning = "side of the line from pivot 2 to the handle"},
    {.name = "handle", .slot = is<kSides, &FiveBar::mode, &engine::WorkingMode::handle_left>,
     .meaning = "side of the line from elbow 1 to elbow 2"},
};

constexpr Key kAxis[]{
    {.name = "counts_per_turn", .slot = at<&engine::Axis::counts_per_turn>, .need = required, .range = {100, 1e9},
     .meaning = "of the encoder, at the joint"},
    {.name = "zero_deg", .slot = at<&engine::Axis::zero>, .need = required, .range = {-720, 720}, .per_si = kDegrees,
     .meaning = "angle at count 0"},
    {.name = "torque_limit_mn_m", .slot = at<&engine::Axis::torque_limit>, .need = required, .range = kTorque, .per_si = kMilli,
     .meaning = "the most that the motor gives, at the joint"},
    {.name = "torque_forever_mn_m", .slot = at<&engine::Axis::torque_forever>, .need = required, .range = kTorque, .per_si = kMilli,
     .meaning = "what it can give for ever"},
    {.name = "codes_full_scale", .slot = at<&engine::Axis::codes_full_scale>, .need = required, .range = {1, 2147483647},
     .meaning = "code of the torque limit"},
};

constexpr Key kHaply[]{
    {.name = "id", .slot = at<&HaplyWiring::id>, .range = {1, 255},
     .meaning = "of the device on the board"},
    {.name = "port_1", .slot = at<&HaplyWiring::port, 0>, .range = kPort,
     .meaning = "of pivot 1"},
    {.name = "port_2", .slot = at<&HaplyWiring::port, 1>, .range = kPort,
     .meaning = "of pivot 2"},
    {.name = "motor_1", .slot = is<kWays, &HaplyWiring::motor_clockwise, 0>,
     .meaning = "which way a positive torque turns"},
    {.name = "motor_2", .slot = is<kWays, &HaplyWiring::motor_clockwise, 1>,
     .meaning = "the same at pivot 2"},
    {.name = "encoder_1", .slot = is<kWays, &HaplyWiring::encoder_clockwise, 0>,
     .meaning = "which way counts grow"},
    {.name = "encoder_2", .slot = is<kWays, &HaplyWiring::encoder_clockwise, 1>,
     .meaning = "the same at pivot 2"},
    {.name = "grip_pin", .slot = at<&HaplyWiring::grip_pin>, .range = {54, 65},
     .meaning = "analogue input that tells a held handle; left out: none"},
    {.name = "grip_threshold_adc", .slot = at<&HaplyWiring::grip_threshold>, .range = {0, 4095},
     .meaning = "the handle is held from this value up"},
};

constexpr Key kBoard[]{
    {.name = "id", .slot = at<&OpenWiring::id>, .range = {0, 4294967295},
     .meaning = "the board's own; left out: any board"},
    {.name = "watchdog_ms", .slot = at<&OpenWiring::watchdog>, .range = {5, 50}, .per_si = kMilli,
     .meaning = "without a torque for so long the board stops"},
    {.name = "channel_1", .slot = at<&OpenWiring::channel, 0>, .range = kPort,
     .meaning = "of pivot 1, motor and encoder"},
    {.name = "channel_2", .slot = at<&OpenWiring::channel, 1>, .range = kPort,
     .meaning = "of pivot 2"},
    {.name = "motor_1", .slot = is<kWays, &OpenWiring::motor_clockwise, 0>,
     .meaning = "which way a positive torque turns"},
    {.name = "motor_2", .slot = is<kWays, &OpenWiring::motor_clockwise, 1>,
     .meaning = "the same at pivot 2"},
    {.name = "encoder_1", .slot = is<kWays, &OpenWiring::encoder_clockwise, 0>,
     .meaning = "which way counts grow"},
    {.name = "encoder_2", .slot = is<kWays, &OpenWiring::encoder_clockwise, 1>,
     .meaning = "the same at pivot 2"},
};

constexpr Key kGantry[]{
    {.name = "name", .slot = at<&GantrySpec::name>, .need = required, .form = Form::any,
     .meaning = "of the machine, 1 to 64 bytes"},
    {.name = "damping_n_s_per_m", .slot = at<&GantrySpec::damping>, .range = {0, 100},
     .meaning = "of the machine at its handle, along the axis that is damped least"},
    {.name = "motor_time_s", .slot = at<&GantrySpec::motor_time>, .range = {0, 1e5},
     .meaning = "thermal time constant of the motors; 0: not known"},
};

constexpr Key kStraightAxis[]{
    {.name = "radius_mm", .slot = at<&StraightAxis::radius>, .need = required, .range = {0, 200, true}, .per_si = kMilli,
     .meaning = "of the drum or pinion: mm of way by rad of the motor"},
    {.name = "counts_per_turn", .slot = at<&StraightAxis::motor, &engine::Axis::counts_per_turn>, .need = required, .range = {100, 1e9},
     .meaning = "of the encoder, at the drum"},
    {.name = "torque_limit_mn_m", .slot = at<&StraightAxis::motor, &engine::Axis::torque_limit>, .need = required, .range = kTorque, .per_si = kMilli,
     .meaning = "the most that the motor gives, at the drum; by the radius it is a force"},
    {.name = "torque_forever_mn_m", .slot = at<&StraightAxis::motor, &engine::Axis::torque_forever>, .need = required, .range = kTorque, .per_si = kMilli,
     .meaning = "what it can give for ever"},
    {.name = "codes_full_scale", .slot = at<&StraightAxis::motor, &engine::Axis::codes_full_scale>, .need = required, .range = {1, 2147483647},
     .meaning = "code of the torque limit"},
    {.name = "low_mm", .slot = at<&StraightAxis::low>, .need = required, .range = kEnd, .per_si = kMilli,
     .meaning = "lower end of the workspace: a reading outside it ends the trial"},
    {.name = "high_mm", .slot = at<&StraightAxis::high>, .need = required, .range = kEnd, .per_si = kMilli,
     .meaning = "upper end of the workspace"},
    {.name = "home_mm", .slot = at<&StraightAxis::home>, .need = required, .range = kEnd, .per_si = kMilli,
     .meaning = "where the handle rests when the device is switched on"},
};

constexpr Key kGantryBoard[]{
    kBoard[0],
    kBoard[1],
    {.name = "channel_x", .slot = at<&OpenWiring::channel, 0>, .range = {1, 3},
     .meaning = "of the axis, motor and encoder"},
    {.name = "channel_y", .slot = at<&OpenWiring::channel, 1>, .range = {1, 3},
     .meaning = "the same"},
    {.name = "channel_z", .slot = at<&OpenWiring::channel, 2>, .range = {1, 3},
     .meaning = "the same"},
    {.name = "motor_x", .slot = is<kSenses, &OpenWiring::motor_clockwise, 0>,
     .meaning = "which way a positive torque pushes"},
    {.name = "motor_y", .slot = is<kSenses, &OpenWiring::motor_clockwise, 1>,
     .meaning = "the same"},
    {.name = "motor_z", .slot = is<kSenses, &OpenWiring::motor_clockwise, 2>,
     .meaning = "the same; forward is up"},
    {.name = "encoder_x", .slot = is<kSenses, &OpenWiring::encoder_clockwise, 0>,
     .meaning = "which way counts grow"},
    {.name = "encoder_y", .slot = is<kSenses, &OpenWiring::encoder_clockwise, 1>,
     .meaning = "the same"},
    {.name = "encoder_z", .slot = is<kSenses, &OpenWiring::encoder_clockwise, 2>,
     .meaning = "the same"},
};

constexpr Key kComedi[]{
    {.name = "counter_subdevice", .slot = at<&ComediWiring::counter_subdevice>, .range = kChannel,
     .meaning = "of the card's counters"},
    {.name = "counter_1", .slot = at<&ComediWiring::counter, 0>, .range = kChannel,
     .meaning = "channel of pivot 1"},
    {.name = "counter_2", .slot = at<&ComediWiring::counter, 1>, .range = kChannel,
     .meaning = "channel of pivot 2"},
    {.name = "turns_1", .slot = is<kWays, &ComediWiring::counter_clockwise, 0>,
     .meaning = "which way counts grow"},
    {.name = "turns_2", .slot = is<kWays, &ComediWiring::counter_clockwise, 1>,
     .meaning = "the same at pivot 2"},
    {.name = "output_subdevice", .slot = at<&ComediWiring::output_subdevice>, .range = kChannel,
     .meaning = "of the card's analogue outputs"},
    {.name = "output_1", .slot = at<&ComediWiring::output, 0>, .range = kChannel,
     .meaning = "channel of pivot 1"},
    {.name = "output_2", .slot = at<&ComediWiring::output, 1>, .range = kChannel,
     .meaning = "channel of pivot 2"},
    {.name = "output_range", .slot = at<&ComediWiring::range>, .range = kChannel,
     .meaning = "of the outputs, by its number"},
    {.name = "volts_per_n_m_1", .slot = at<&ComediWiring::volts_per_newton_metre, 0>, .range = kVolts,
     .meaning = "of motor 1; negative: it turns the other way"},
    {.name = "volts_per_n_m_2", .slot = at<&ComediWiring::volts_per_newton_metre, 1>, .range = kVolts,
     .meaning = "of motor 2"},
};

constexpr double kGrams = 1e3;
constexpr double kGramSquareCm = 1e7;  // g cm^2

using engine::RigRecord;

constexpr Key kRecord[]{
    {.name = "device", .slot = at<&RigRecord::device>, .need = required, .form = Form::free,
     .meaning = "that was commissioned, as --device has it"},
    {.name = "board_id", .slot = at<&RigRecord::board>, .range = {0, 4294967295},
     .meaning = "of the open board; left out: the device says none"},
    {.name = "program", .slot = at<&RigRecord::program>, .need = required, .form = Form::free,
     .meaning = "version of the program that did it"},
    {.name = "calibration_sha256", .slot = at<&RigRecord::calibration>, .need = required, .form = Form::free,
     .meaning = "of the calibration's canonical text"},
    {.name = "pulse_n", .slot = at<&RigRecord::force>, .need = required, .range = {0.01, 1},
     .meaning = "force of the pulses that open a session"},
    {.name = "damping_n_s_per_m", .slot = at<&RigRecord::damping>, .need = required, .range = {0, 1e3},
     .meaning = "at the handle, less a fifth: of a linkage the least within reach for x from -40 to 40 and y from 0 to 60 mm"},
    {.name = "friction_n", .slot = at<&RigRecord::friction>, .need = required, .range = {0, 1e3},
     .meaning = "dry, at the handle, the least where it was pushed"},
    {.name = "round_trip_ms", .slot = at<&RigRecord::round_trip>, .need = required, .range = {0, 1e3}, .per_si = kMilli,
     .meaning = "from a question to its answer; 0: the device is not asked"},
    {.name = "rate_hz", .slot = at<&RigRecord::rate_hz>, .need = required, .range = {0, 1e4},
     .meaning = "at which every tick has a new reading, one tick old"},
    {.name = "stiffness_n_per_m", .slot = at<&RigRecord::stiffness>, .need = required, .range = {0, 1e6},
     .meaning = "usable at 1 kHz"},
};

constexpr Key kLinkageRecord[]{
    {.name = "handle_g", .slot = at<&LinkageRecord::dynamics, &HandleDynamics::handle_mass>, .need = required, .range = {0, 1e4}, .per_si = kGrams,
     .meaning = "handle and free links, lumped at the handle"},
    {.name = "inertia_1_g_cm2", .slot = at<&LinkageRecord::dynamics, &HandleDynamics::inertia, 0>, .need = required, .range = {0, 1e7}, .per_si = kGramSquareCm,
     .meaning = "driven link 1 with its motor"},
    {.name = "inertia_2_g_cm2", .slot = at<&LinkageRecord::dynamics, &HandleDynamics::inertia, 1>, .need = required, .range = {0, 1e7}, .per_si = kGramSquareCm,
     .meaning = "driven link 2 with its motor"},
    {.name = "damping_1_mn_m_s", .slot = at<&LinkageRecord::dynamics, &HandleDynamics::damping, 0>, .need = required, .range = {0, 1e4}, .per_si = kMilli,
     .meaning = "at motor 1, by rad/s"},
    {.name = "damping_2_mn_m_s", .slot = at<&LinkageRecord::dynamics, &HandleDynamics::damping, 1>, .need = required, .range = {0, 1e4}, .per_si = kMilli,
     .meaning = "at motor 2, by rad/s"},
    {.name = "friction_1_mn_m", .slot = at<&LinkageRecord::dynamics, &HandleDynamics::friction, 0>, .need = required, .range = {0, 1e4}, .per_si = kMilli,
     .meaning = "dry, at motor 1"},
    {.name = "friction_2_mn_m", .slot = at<&LinkageRecord::dynamics, &HandleDynamics::friction, 1>, .need = required, .range = {0, 1e4}, .per_si = kMilli,
     .meaning = "dry, at motor 2"},
    {.name = "handle_damping_n_s_per_m", .slot = at<&LinkageRecord::dynamics, &HandleDynamics::handle_damping>, .need = required, .range = {0, 1e3},
     .meaning = "at the handle itself: a plate, a sleeve, air"},
    {.name = "handle_friction_n", .slot = at<&LinkageRecord::dynamics, &HandleDynamics::handle_friction>, .need = required, .range = {0, 1e3},
     .meaning = "dry, at the handle itself"},
    {.name = "mark_mm", .slot = at<&LinkageRecord::mark>, .range = {-1000, 1000}, .per_si = kMilli,
     .meaning = "where the handle is brought at each opening; left out: the operator's word"},
};

constexpr Key kAxisRecord[]{
    {.name = "mass_g", .slot = at<&AxisRecord::dynamics, &AxisDynamics::mass>, .need = required, .range = {0, 1e5}, .per_si = kGrams,
     .meaning = "that its motor moves"},
    {.name = "damping_n_s_per_m", .slot = at<&AxisRecord::dynamics, &AxisDynamics::damping>, .need = required, .range = {0, 1e3},
     .meaning = "of the axis"},
    {.name = "friction_n", .slot = at<&AxisRecord::dynamics, &AxisDynamics::friction>, .need = required, .range = {0, 1e3},
     .meaning = "dry, of the axis"},
    {.name = "pull_n", .slot = at<&AxisRecord::dynamics, &AxisDynamics::pull>, .need = required, .range = {-1e3, 1e3},
     .meaning = "that pulls it backward all the time: weight, of the vertical axis"},
    {.name = "mark_mm", .slot = at<&AxisRecord::mark>, .need = required, .range = {-2000, 2000}, .per_si = kMilli,
     .meaning = "where the handle is brought at each opening"},
};
// clang-format on

/// What every such machine has, and a wiring, which it may have.
template <auto... Steps>
void* always(Calibration& machine, bool /*make*/) {
    return &part_of<Steps...>(machine);
}
template <std::size_t I>
void* straight(Calibration& machine, bool /*make*/) {
    return &machine.gantry->axes[I];
}
template <auto Wiring>
void* wiring(Calibration& machine, bool make) {
    auto& wired = machine.*Wiring;
    return wired || make ? &(wired ? *wired : wired.emplace()) : nullptr;
}

constexpr MachineTable kPantographTables[]{
    {"pantograph", kPantograph,
     [](Calibration& machine, bool) -> void* {
         return &machine;
     }},
    {"linkage", kLinkage, always<&Calibration::pantograph, &PantographSpec::linkage>},
    {"axis_1", kAxis, always<&Calibration::pantograph, &PantographSpec::axes, 0>},
    {"axis_2", kAxis, always<&Calibration::pantograph, &PantographSpec::axes, 1>},
    {"haply", kHaply, wiring<&Calibration::haply>, false},
    {"board", kBoard, wiring<&Calibration::board>, false},
    {"comedi", kComedi, wiring<&Calibration::comedi>, false}};

constexpr MachineTable kGantryTables[]{{"gantry", kGantry, wiring<&Calibration::gantry>},
                                       {"axis_x", kStraightAxis, straight<0>},
                                       {"axis_y", kStraightAxis, straight<1>},
                                       {"axis_z", kStraightAxis, straight<2>},
                                       {"board", kGantryBoard, wiring<&Calibration::board>}};

}  // namespace

constinit const RecordKeys kRecordKeys{kRecord, kLinkageRecord, kAxisRecord};

std::span<const MachineTable> machine_tables(bool gantry) noexcept {
    return gantry ? std::span<const MachineTable>(kGantryTables) : kPantographTables;
}

Calibration begun_pantograph() {
    Calibration machine;
    machine.pantograph.origin = {};
    return machine;
}

std::vector<TableText> calibration_reference() {
    return {{"[[pantograph]]", "once for each machine", kPantograph},
            {"[pantograph.linkage]", "required", kLinkage},
            {"[pantograph.axis_1]", "and [pantograph.axis_2], required", kAxis},
            {"[pantograph.haply]", "of a Haply board", kHaply},
            {"[pantograph.board]", "of an open board", kBoard},
            {"[pantograph.comedi]", "of a DAQ card", kComedi},
            {"[[gantry]]", "a machine of three straight axes, instead of a pantograph", kGantry},
            {"[gantry.axis_x]", "and [gantry.axis_y], [gantry.axis_z], required", kStraightAxis},
            {"[gantry.board]", "its open board, required", kGantryBoard},
            {"[commissioning]", "written by palpate commission", kRecord},
            {"[commissioning]", "and of a pantograph", kLinkageRecord},
            {"[commissioning.axis_x]", "and axis_y, axis_z, of three straight axes", kAxisRecord}};
}

}  // namespace palpate::protocols
