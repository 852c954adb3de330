#pragma once

#include "pliant/core/step/time_integration.h"

namespace pliant {

const TimeIntegrationRegistry& time_integrations();

}  // namespace pliant
