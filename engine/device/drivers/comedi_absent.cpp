#include <stdexcept>

#include "engine/device/drivers/comedi_card.hpp"

namespace palpate::engine {

std::unique_ptr<Device> open_comedi(const std::string& /*file*/,
                                    const Calibration& /*calibration*/) {
    throw std::runtime_error(
        "this palpate was built without Comedi: install libcomedi-dev and build again");
}

}  // namespace palpate::engine
