#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "engine/device/device.hpp"
#include "engine/device/pantograph.hpp"

namespace palpate::engine {

/// The few calls that a pantograph needs of a data acquisition card, wired as ComediWiring says: of
/// each axis, 0 or 1, a counter in and a voltage out. Calls return 0, or the driver's error number;
/// none throws. One thread at a time.
class DaqCard {
public:
    /// What an output channel can do.
    struct Output {
        double min = 0.0;       ///< V at code 0
        double max = 0.0;       ///< V at code `top`
        std::uint32_t top = 0;  ///< largest code
    };

    DaqCard() = default;
    DaqCard(const DaqCard&) = delete;
    DaqCard& operator=(const DaqCard&) = delete;
    virtual ~DaqCard() = default;

    /// Also again, after close().
    [[nodiscard]] virtual int open() noexcept = 0;
    /// After this no other call may be made but open(). What the outputs hold, they go on holding.
    virtual void close() noexcept = 0;
    /// A quadrature counter, every edge counted; one that counts already keeps its value.
    /// @param top  its largest value, 2^bits - 1
    [[nodiscard]] virtual int prepare_counter(std::size_t axis, std::uint32_t& top) noexcept = 0;
    [[nodiscard]] virtual int prepare_output(std::size_t axis, Output& output) noexcept = 0;
    [[nodiscard]] virtual int read_counter(std::size_t axis, std::uint32_t& value) noexcept = 0;
    [[nodiscard]] virtual int write_output(std::size_t axis, std::uint32_t code) noexcept = 0;

    [[nodiscard]] virtual std::string name() const = 0;  ///< e.g. "/dev/comedi0"
    [[nodiscard]] virtual std::string explain(int error) const = 0;
};

/// A pantograph on a data acquisition card: encoders on two counters, motor amplifiers (volts in,
/// torque out) on two analogue outputs.
///
///     counts = +- unwrapped counter + offset          angles and HIP: Pantograph
///     volts  = torque * volts_per_newton_metre        code = (volts - min) / (max - min) * top
///
/// The offset is such that the handle stands at the calibration's home when the card is opened, and
/// again at each reconnect(); without a home it is 0: the counters' own values, as signed numbers,
/// were calibrated. The torque limit of an axis is what both its motor and its output range can
/// give, and what it gives for ever is no more than that.
///
/// Zero volts, which is the middle code of a range with both signs and never code 0, is the last
/// thing written on every way out: fault, a force that is not a number, reconnect, destructor. When
/// the program is killed nobody writes it: a card holds what it had. Wire the amplifiers' enable
/// input to something that notices.
///
/// A fault stays until reconnect(). Nothing here was tried on hardware.
class ComediDevice : public Device {
public:
    /// Opens the card and writes zero volts.
    /// @throws std::invalid_argument if the calibration has no [comedi] part or one that cannot be
    /// @throws std::runtime_error    if the card cannot be opened or is not fit: what, and the
    ///       remedy
    ComediDevice(std::unique_ptr<DaqCard> card, const Calibration& calibration);
    ~ComediDevice() override;

    [[nodiscard]] Reading read() noexcept override;
    AppliedForce write(const Vec3& force) noexcept override;
    [[nodiscard]] std::string name() const override;
    [[nodiscard]] DeviceTraits traits() const noexcept override;
    [[nodiscard]] std::optional<double> weakest_force(const Vec3& hip) const noexcept override {
        return pantograph_.weakest_force(Vec2(hip));
    }
    [[nodiscard]] std::optional<double> reading_error(const Vec3& hip) const noexcept override {
        return pantograph_.reading_error(Vec2(hip));
    }
    bool prove_zero() noexcept override;
    [[nodiscard]] bool reconnect() override;
    [[nodiscard]] std::size_t homings() const noexcept override { return homings_; }
    void forget_home() override;
    [[nodiscard]] std::string trouble() const override;

private:
    /// One motor with its encoder.
    struct Channel {
        std::uint32_t counter_top = 0;
        std::uint32_t last = 0;  ///< counter as read
        std::int64_t count = 0;  ///< unwrapped, in the card's direction
        std::int64_t offset = 0;
        DaqCard::Output output{};
        std::uint32_t zero = 0;  ///< code of zero volts
        double volts = 0.0;      ///< of the torque limit: nothing beyond is ever written
    };

    [[nodiscard]] std::string start();
    [[nodiscard]] std::string prepare(std::size_t axis);
    void shut() noexcept;
    void silence() noexcept;
    void fail(DeviceFault fault, int error) noexcept;
    [[nodiscard]] bool follow(std::size_t axis) noexcept;
    [[nodiscard]] std::int64_t counted(std::size_t axis) const noexcept;
    [[nodiscard]] std::uint32_t code(std::size_t axis, double volts) const noexcept;
    [[nodiscard]] std::string refused(int error) const;

    std::unique_ptr<DaqCard> card_;
    Calibration calibration_;
    ComediWiring wiring_;
    Pantograph pantograph_;  ///< its torque limits are those of motors and outputs together
    std::array<Channel, 2> channels_{};
    std::optional<Pantograph::Fix> fix_;  ///< of the last reading
    bool open_ = false;
    DeviceFault fault_ = DeviceFault::none;  ///< until reconnect()
    int error_ = 0;                          ///< the card's, 0: none
    std::size_t homings_ = 0;                ///< poses taken for home since it was opened
    std::string problem_;                    ///< why the card could not be opened again
};

}  // namespace palpate::engine
