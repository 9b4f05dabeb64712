#pragma once
#include <map>
#include <rsb/converter/Converter.h>

namespace rsb::converter {
template <class Wire> class Repository {
public:
    typedef boost::shared_ptr<Repository<Wire>> Ptr;
    void registerConverter(typename Converter<Wire>::Ptr converter) { known[converter->getWireSchema()] = converter; }
    std::map<std::string, typename Converter<Wire>::Ptr> known;
};

template <class Wire> typename Repository<Wire>::Ptr converterRepository()
{
    static const typename Repository<Wire>::Ptr repository(new Repository<Wire>);
    return repository;
}
} // namespace rsb::converter
