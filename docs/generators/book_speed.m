#!/usr/bin/env -S octave-cli --quiet --no-init-file
% The Octave side of book_speed.py: a request is a line, the answer is a line. In the folder that
% BOOK_SPEED names lie RR.m, as the book writes it, shared.m, and g.m, which makes the inline g.
1;
warning('off', 'all');
cd(getenv('BOOK_SPEED'));
run('g.m');

function dx = counted(t, x, f)
  global calls
  calls += 1;
  dx = f(t, x);
end

ways.inline = @(t,x) g(t,x);  % Octave's ode45 wants a handle
ways.file = @RR;
ways.shared = @shared;
time = [0 5];
x0 = [pi/4 0 pi/3 0];
while true
  try
    line = input('', 's');  % fgetl would wait for the line after
  catch
    break;
  end
  words = strsplit(line, ' ');
  numbers = str2double(words(3:end));
  switch words{1}
    case 'version'
      printf('ok %s\n', version());
    case 'solve'  % seconds of ode45
      f = ways.(words{2});
      options = odeset('RelTol', numbers(1), 'AbsTol', numbers(2));
      begun = tic;
      [t,xs] = ode45(f, time, x0, options);
      printf('ok %.9g\n', toc(begun));
    case 'look'  % right-hand sides that it takes, and where it ends
      global calls
      calls = 0;
      f = ways.(words{2});
      options = odeset('RelTol', numbers(1), 'AbsTol', numbers(2));
      [t,xs] = ode45(@(t,x) counted(t,x,f), time, x0, options);
      printf('ok %d %.17g %.17g\n', calls, xs(end,[1 3]));
    case 'call'  % seconds of so many right-hand sides
      f = ways.(words{2});
      x = x0';
      begun = tic;
      for k = 1:numbers(1)
        dx = f(0, x);
      end
      printf('ok %.9g\n', toc(begun));
  end
  fflush(stdout);
end
