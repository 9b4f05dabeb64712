// A model of RSB's class: its signatures.
#pragma once
#include <boost/shared_ptr.hpp>
#include <string>
#include <utility>

namespace rsb {
typedef std::pair<std::string, boost::shared_ptr<void>> AnnotatedData;

namespace converter {
template <class Wire> class Converter {
public:
    typedef boost::shared_ptr<Converter<Wire>> Ptr;
    Converter(const std::string &data, const std::string &schema, bool) : data_(data), schema_(schema) {}
    virtual ~Converter() = default;
    virtual std::string serialize(const AnnotatedData &data, Wire &wire) = 0;
    virtual AnnotatedData deserialize(const std::string &schema, const Wire &wire) = 0;
    std::string getDataType() const { return data_; }
    std::string getWireSchema() const { return schema_; }

private:
    std::string data_, schema_;
};
} // namespace converter
} // namespace rsb
