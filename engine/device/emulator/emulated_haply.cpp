#include "engine/device/emulator/emulated_haply.hpp"

#include "engine/device/drivers/serial_link.hpp"

namespace palpate::engine {
std::unique_ptr<HaplyDevice> open_haply(const std::string& path,
                                        const Calibration& calibration,
                                        const HaplyTiming& timing,
                                        const GuardTiming& guard) {
    return std::make_unique<HaplyDevice>(calibration, std::make_unique<SerialLink>(path),
                                         std::make_unique<GuardProcess>(guard), timing);
}

}  // namespace palpate::engine
