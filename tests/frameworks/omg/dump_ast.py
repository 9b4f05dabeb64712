"""A back end for omniidl, run by it and not by us: every declaration in the form of the vectors' ``ast``, as JSON."""

import json

from omniidl import idlast, idltype, idlutil

WORDS = {
    idltype.tk_short: "short",
    idltype.tk_long: "long",
    idltype.tk_ushort: "ushort",
    idltype.tk_ulong: "ulong",
    idltype.tk_float: "float",
    idltype.tk_double: "double",
    idltype.tk_boolean: "boolean",
    idltype.tk_char: "char",
    idltype.tk_octet: "octet",
    idltype.tk_longlong: "longlong",
    idltype.tk_ulonglong: "ulonglong",
    idltype.tk_wchar: "wchar",
    idltype.tk_any: "any",
}


def run(tree, _arguments):
    found = {}
    declarations(tree.declarations(), found)
    print(json.dumps(found))


def declarations(nodes, found):
    for node in nodes:
        if isinstance(node, idlast.Module):
            declarations(node.definitions(), found)
        elif isinstance(node, idlast.Interface):
            declarations(node.contents(), found)
        elif isinstance(node, idlast.Struct):
            inner(node.members(), found)
            members = [[d.identifier(), spelled(m.memberType()), list(d.sizes())] for m in node.members() for d in m.declarators()]
            found[name(node)] = {"struct": members}
        elif isinstance(node, idlast.Union):
            cases = [case(each) for each in node.cases()]
            inner(node.cases(), found)
            if node.constrType():
                declarations([node.switchType().decl()], found)
            found[name(node)] = {"union": cases, "switch": spelled(node.switchType())}
        elif isinstance(node, idlast.Enum):
            found[name(node)] = {"enum": [name(each) for each in node.enumerators()]}
        elif isinstance(node, idlast.Const):
            value = node.value()
            found[name(node)] = {"const": name(value) if isinstance(value, idlast.Enumerator) else str(value)}
        elif isinstance(node, idlast.Typedef):
            if node.constrType():
                declarations([node.aliasType().decl()], found)
            for each in node.declarators():
                found[name(each)] = {"typedef": spelled(node.aliasType()), "dims": list(each.sizes())}


def inner(members, found):
    for member in members:
        if member.constrType():
            type_ = member.caseType() if isinstance(member, idlast.UnionCase) else member.memberType()
            declarations([type_.decl()], found)


def name(node):
    return idlutil.ccolonName(node.scopedName())


def case(node):
    declarator = node.declarator()
    return [[label(each) for each in node.labels()], declarator.identifier(), spelled(node.caseType()), list(declarator.sizes())]


def label(node):
    if node.default():
        return "default"
    value = node.value()
    return name(value) if isinstance(value, idlast.Enumerator) else value


def spelled(type_):
    kind = type_.kind()
    if kind in WORDS:
        return WORDS[kind]
    if kind == idltype.tk_string:
        return {"string": type_.bound()}
    if kind == idltype.tk_wstring:
        return {"wstring": type_.bound()}
    if kind == idltype.tk_sequence:
        return {"seq": spelled(type_.seqType()), "bound": type_.bound()}
    return {"ref": name(type_.decl())} if hasattr(type_, "decl") else {"other": kind}
