#pragma once

namespace koboshi::sim {

// Ends a library's object by the library's own function, for std::unique_ptr.
template <auto kDelete>
struct DeleteBy {
  template <typename T>
  void operator()(T* object) const {
    kDelete(object);
  }
};

}  // namespace koboshi::sim
