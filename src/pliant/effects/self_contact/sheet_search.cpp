#include "pliant/effects/self_contact/sheet_search.h"

#include "pliant/solvers/device/cuda_library.h"

namespace pliant {

std::unique_ptr<SheetSearch> make_cuda_sheet_search(const SheetTreeSearch& cpu) {
  std::unique_ptr<SheetSearch> search;
  cuda_function<MakeCudaSheetSearch>(kMakeCudaSheetSearch)(cpu, search);
  return search;
}

}  // namespace pliant
