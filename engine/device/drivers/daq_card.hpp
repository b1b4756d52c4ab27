#pragma once

#include <cstdint>
#include <string>

namespace palpate::engine {

/// The few calls that a pantograph needs of a data acquisition card: two counters in, two voltages
/// out. Calls return 0, or the driver's error number; none throws. One thread at a time.
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

    [[nodiscard]] virtual int open() noexcept = 0;
    /// After this no other call may be made but open(). What the outputs hold, they go on holding.
    virtual void close() noexcept = 0;
    /// A quadrature counter, every edge counted; one that counts already keeps its value.
    /// @param top  its largest value, 2^bits - 1
    [[nodiscard]] virtual int prepare_counter(std::uint32_t subdevice,
                                              std::uint32_t channel,
                                              std::uint32_t& top) noexcept = 0;
    [[nodiscard]] virtual int prepare_output(std::uint32_t subdevice,
                                             std::uint32_t channel,
                                             std::uint32_t range,
                                             Output& output) noexcept = 0;
    [[nodiscard]] virtual int read_counter(std::uint32_t subdevice,
                                           std::uint32_t channel,
                                           std::uint32_t& value) noexcept = 0;
    [[nodiscard]] virtual int write_output(std::uint32_t subdevice,
                                           std::uint32_t channel,
                                           std::uint32_t range,
                                           std::uint32_t code) noexcept = 0;

    [[nodiscard]] virtual std::string name() const = 0;  ///< e.g. "/dev/comedi0"
    [[nodiscard]] virtual std::string explain(int error) const = 0;
};

}  // namespace palpate::engine
