" Checks the package for Vim and Neovim: vim -es -S package.vim, with its folder on the runtime path, in a folder with `told`,
" what `droptower check` printed of wrong.toml; $SCRIPTS is the folder of the shipped scripts.
set nocompatible nomore
let s:failed = 0

function s:same(found, expected, of) abort
  if a:found !=# a:expected
    let s:failed = 1
    call writefile([a:of .. ': ' .. string(a:found) .. ' instead of ' .. string(a:expected)], 'failed', 'a')
  endif
endfunction

filetype plugin on
syntax on

" The place and the kind of each message.
compiler droptower
cgetfile told
let s:mistakes = map(filter(getqflist(), 'v:val.valid'), '[bufname(v:val.bufnr), v:val.lnum, v:val.col, v:val.type, v:val.text]')
call s:same(s:mistakes[-1], ['wrong.toml', 2, 10, 'e', 'unknown key `mas`'], 'the last mistake')
call s:same(len(s:mistakes), len(filter(readfile('told'), 'v:val =~# "^error: "')), 'the number of mistakes')

" Colours of words, each with the line that it is in.
for [s:line, s:word, s:group] in [
      \ ['let x = 1.5e-3;', '1.5e-3', 'rhaiNumber'],
      \ ['let x = 1.5e-3;', 'let', 'rhaiDeclaration'],
      \ ['fn area(a) { a }', 'area', 'rhaiFunction'],
      \ ['simulate_all(list)', 'simulate_all', 'rhaiDroptower'],
      \ ['scenario(path).with(#{ a: 1 })', 'with', 'rhaiDroptower'],
      \ ['`a ${minimize(x)} b`', 'minimize', 'rhaiDroptower'],
      \ ['`a ${#{ b: `c` }.b} d` + x.mean()', 'mean', 'rhaiDroptower'],
      \ ['/* a /* b */ while */ 1', '1', 'rhaiNumber'],
      \ ['//! what it does', 'what', 'rhaiDocComment'],
      \ ['let a = "let // x"; // y', '// x', 'rhaiString'],
      \ ['"a \" b".len()', 'len', 'rhaiDroptower'],
      \ ['for i in 0..3 { break; }', 'break', 'rhaiStatement'],
      \ ]
  enew!
  set filetype=rhai
  call setline(1, s:line)
  call s:same(synIDattr(synID(1, match(s:line, '\V' .. escape(s:word, '\')) + 1, 1), 'name'), s:group, s:line)
endfor

" Scripts are recognised by their name, and every string, comment and brace in them ends.
for s:script in glob($SCRIPTS .. '/**/*.rhai', 0, 1)
  execute 'edit!' fnameescape(s:script)
  call s:same(&filetype, 'rhai', s:script)
  call s:same(&makeprg, 'droptower script --check %:S', s:script)
  syntax sync fromstart
  call append('$', 'fn end_of_script() {}')
  call s:same(synIDattr(synID(line('$'), 4, 1), 'name'), 'rhaiFunction', s:script)
endfor
execute s:failed ? 'cquit!' : 'qall!'
