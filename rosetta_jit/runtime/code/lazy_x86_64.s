# Lazy binding for x86-64 (System V ABI): $functions, and what each of them does when it is called for the first time.
#
# A function jumps to where its slot says. At first that is its own second half: it calls the function's finder, a Python object without arguments,
# which writes the slot, and then jumps there with the arguments as they were. A finder that fails has set Python's error: then the caller is given
# the function's failure. Functions have up to four arguments, all of them integers or pointers. Python fills the three tables when this is loaded.
.text
$stubs
find:
pushq %rdi
pushq %rsi
pushq %rdx
pushq %rcx
pushq %rax
leaq finders(%rip), %rdi
movq (%rdi,%rax,8), %rdi
callq PyObject_CallNoArgs@PLT
testq %rax, %rax
je failed
movq %rax, %rdi
callq Py_DecRef@PLT
popq %rax
popq %rcx
popq %rdx
popq %rsi
popq %rdi
leaq slots(%rip), %r10
jmpq *(%r10,%rax,8)
failed:
popq %rax
addq $$32, %rsp
leaq failures(%rip), %r10
movq (%r10,%rax,8), %rax
retq
.bss
.p2align 3
.globl slots
slots: .zero $size
.globl finders
finders: .zero $size
.globl failures
failures: .zero $size
