" Vim compiler file: `:make` checks the scenario or script that is open, and lists its mistakes.
if exists("current_compiler")
  finish
endif
let current_compiler = "droptower"

let s:save_cpo = &cpo
set cpo&vim

if &filetype ==# "rhai"
  CompilerSet makeprg=droptower\ script\ --check\ %:S
else
  CompilerSet makeprg=droptower\ check\ %:S
endif
" A message on its first line, its place on the second; what is left of it is the text around that place.
CompilerSet errorformat=%E%trror:\ %m,
      \%E%trror[%*[^]]]:\ %m,
      \%W%tarning:\ %m,
      \%W%tarning[%*[^]]]:\ %m,
      \%Z\ %#-->\ %f:%l:%c,
      \%Z\ %#╭▸\ %f:%l:%c,
      \%-G%.%#

let &cpo = s:save_cpo
unlet s:save_cpo
