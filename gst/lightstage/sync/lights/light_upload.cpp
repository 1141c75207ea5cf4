// SPDX-License-Identifier: LGPL-2.1-or-later
#include "light_upload.hpp"

#include "gst/base/log/errors.hpp"

namespace inverse {

bool upload_program(GstElement* element, LightDriver& driver, const LightProgram& program,
                    const std::function<bool()>& given_up) {
  try {
    driver.upload(program);
    return true;
  } catch (const Error& error) {
    if (!given_up()) post_error(element, error);
  } catch (const std::exception& error) {
    post_error(element, Error(ErrorKind::internal, error.what()));
  }
  return false;
}

}  // namespace inverse
