#include "engine/device/drivers/comedi_card.hpp"

#include <cerrno>
#include <utility>

#include <comedilib.h>

#include "engine/device/drivers/comedi_device.hpp"

namespace palpate::engine {
namespace {

/// The library's last error; some of its calls fail without one.
int last_error() noexcept {
    const int error = comedi_errno();
    return error != 0 ? error : EIO;
}

/// Comedi's calls are ioctls of a few microseconds. Written by its manual; no card was at hand.
class ComediCard : public DaqCard {
public:
    ComediCard(std::string file, const ComediWiring& wiring)
        : file_(std::move(file)), wiring_(wiring) {}
    ComediCard(const ComediCard&) = delete;
    ComediCard& operator=(const ComediCard&) = delete;
    ~ComediCard() override { shut(); }

    [[nodiscard]] int open() noexcept override {
        shut();
        comedi_loglevel(0);  // errors are said by us, in a sentence
        card_ = comedi_open(file_.c_str());
        return card_ != nullptr ? 0 : last_error();
    }
    void close() noexcept override { shut(); }

    [[nodiscard]] int prepare_counter(std::size_t axis, std::uint32_t& top) noexcept override {
        const std::uint32_t subdevice = wiring_.counter_subdevice;
        const std::uint32_t channel = wiring_.counter[axis];
        if (comedi_get_subdevice_type(card_, subdevice) != COMEDI_SUBD_COUNTER ||
            channel >= channels(subdevice)) {
            return EINVAL;
        }
        // Cards whose counters do nothing else refuse both calls, and need neither.
        constexpr unsigned kEveryEdge =
            NI_GPCT_COUNTING_MODE_QUADRATURE_X4_BITS | NI_GPCT_COUNTING_DIRECTION_HW_UP_DOWN_BITS;
        if (comedi_set_counter_mode(card_, subdevice, channel, kEveryEdge) >= 0) {
            static_cast<void>(comedi_arm_channel(card_, subdevice, channel, NI_GPCT_ARM_IMMEDIATE));
        }
        top = comedi_get_maxdata(card_, subdevice, channel);
        return top != 0 ? 0 : last_error();
    }

    [[nodiscard]] int prepare_output(std::size_t axis, Output& output) noexcept override {
        const std::uint32_t subdevice = wiring_.output_subdevice;
        const std::uint32_t channel = wiring_.output[axis];
        if (comedi_get_subdevice_type(card_, subdevice) != COMEDI_SUBD_AO ||
            channel >= channels(subdevice)) {
            return EINVAL;
        }
        const comedi_range* volts = comedi_get_range(card_, subdevice, channel, wiring_.range);
        if (volts == nullptr || volts->unit != UNIT_volt) {
            return EINVAL;
        }
        output = {.min = volts->min,
                  .max = volts->max,
                  .top = comedi_get_maxdata(card_, subdevice, channel)};
        return output.top != 0 ? 0 : last_error();
    }

    [[nodiscard]] int read_counter(std::size_t axis, std::uint32_t& value) noexcept override {
        lsampl_t sample = 0;
        if (comedi_data_read(card_, wiring_.counter_subdevice, wiring_.counter[axis], 0,
                             AREF_GROUND, &sample) < 0) {
            return last_error();
        }
        value = sample;
        return 0;
    }

    [[nodiscard]] int write_output(std::size_t axis, std::uint32_t code) noexcept override {
        return comedi_data_write(card_, wiring_.output_subdevice, wiring_.output[axis],
                                 wiring_.range, AREF_GROUND, code) < 0
                 ? last_error()
                 : 0;
    }

    [[nodiscard]] std::string name() const override { return file_; }
    [[nodiscard]] std::string explain(int error) const override { return comedi_strerror(error); }

private:
    [[nodiscard]] std::uint32_t channels(std::uint32_t subdevice) const noexcept {
        const int count = comedi_get_n_channels(card_, subdevice);
        return count > 0 ? static_cast<std::uint32_t>(count) : 0;
    }
    void shut() noexcept {
        if (card_ != nullptr) {
            comedi_close(card_);
            card_ = nullptr;
        }
    }

    std::string file_;
    ComediWiring wiring_;
    comedi_t* card_ = nullptr;
};

}  // namespace

std::unique_ptr<Device> open_comedi(const std::string& file, const Calibration& calibration) {
    return std::make_unique<ComediDevice>(
        std::make_unique<ComediCard>(file, calibration.comedi.value_or(ComediWiring{})),
        calibration);
}

}  // namespace palpate::engine
