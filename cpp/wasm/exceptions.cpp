// A throw gives its message to the host, which ends the call with an error of its own. No handler
// and no destructor runs on the way.
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <new>
#include <stdexcept>
#include <typeinfo>

/// From JavaScript: throws an Error with this message.
extern "C" [[noreturn, clang::import_module("pendcore"), clang::import_name("thrown")]] void
pendcore_thrown(const char* message, std::size_t size);

namespace {

template <class... Kinds>
const char* message_of(const void* exception, const std::type_info& type) {
  const char* message = type.name();
  (void)((type == typeid(Kinds) ? (message = static_cast<const Kinds*>(exception)->what(), true)
                                : false) ||
         ...);
  return message;
}

}  // namespace

extern "C" {

void* __cxa_allocate_exception(std::size_t size) noexcept { return std::malloc(size); }
void __cxa_free_exception(void* exception) noexcept { std::free(exception); }

[[noreturn]] void __cxa_throw(void* exception, std::type_info* type, void (* /*destroy*/)(void*)) {
  const char* message =
      message_of<std::invalid_argument, std::runtime_error, std::logic_error, std::out_of_range,
                 std::domain_error, std::length_error, std::overflow_error, std::bad_alloc>(
          exception, *type);
  pendcore_thrown(message, std::strlen(message));
}
}
