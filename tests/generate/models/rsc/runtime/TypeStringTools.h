// A model of RSC's function: how people write a type.
#pragma once
#include <boost/core/demangle.hpp>
#include <string>
#include <typeinfo>

namespace rsc::runtime {
template <class Type> std::string typeName() { return boost::core::demangle(typeid(Type).name()); }
} // namespace rsc::runtime
